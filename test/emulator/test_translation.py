"""Where translations are kept, and when an array uses one."""

from pathlib import Path

import pytest

from support.avr import Compile
from support.avr import IdealArray as Array
from tilenca.base import paths
from tilenca.emulator import translation
from tilenca.emulator.translation import SETTING, folder, path_of
from tilenca.emulator.translator import make

ENDLESS = "int main(void) { for (;;) { result[0]++; } }"


@pytest.fixture(autouse=True)
def translations(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / "translations"
    monkeypatch.setenv(SETTING, str(place))
    return place


def test_the_setting_tells_the_folder_or_turns_translations_off(
    avr: Compile, translations: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elf = avr(ENDLESS)
    assert folder() == translations
    path = path_of(elf)
    assert path is not None
    assert path.parent == translations
    monkeypatch.setenv(SETTING, "0")
    assert folder() is None
    assert path_of(elf) is None


def test_each_image_has_a_file_of_its_own(avr: Compile) -> None:
    assert path_of(avr(ENDLESS)) != path_of(avr(ENDLESS.replace("++", "--")))


def test_an_array_begins_a_translation_when_it_has_run_for_a_while_and_takes_it_when_it_is_there(
    avr: Compile, monkeypatch: pytest.MonkeyPatch
) -> None:
    elf = avr(ENDLESS)
    begun: list[Path] = []
    monkeypatch.setattr(translation, "begin", begun.append)
    monkeypatch.setattr(translation, "WORTHWHILE_TILE_S", 0.01)
    array = Array(elf, 2)
    array.run(0.004)
    assert begun == []
    array.run(0.004)
    array.run(0.004)
    assert begun == [elf]
    assert not array.is_translated
    make(elf)
    array.run(0.01)
    assert array.is_translated
    assert begun == [elf]


def test_what_is_no_translation_is_left_alone(avr: Compile) -> None:
    elf = avr(ENDLESS)
    path = path_of(elf)
    assert path is not None
    path.parent.mkdir()
    path.write_bytes(b"no library")
    array = Array(elf)
    array.run(0.001)
    assert not array.is_translated


def test_code_that_others_could_have_put_there_is_not_run(avr: Compile, translations: Path) -> None:
    elf = avr(ENDLESS)
    path = make(elf)
    for folder_mode, file_mode, used in (
        (0o777, 0o755, False),
        (0o700, 0o757, False),
        (0o700, 0o755, True),
    ):
        translations.chmod(folder_mode)
        path.chmod(file_mode)
        array = Array(elf)
        array.run(0.001)
        assert array.is_translated == used


def test_without_a_home_there_is_no_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("no home")

    for name in (SETTING, "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(paths, "CHECKOUT", None)
    monkeypatch.setattr(Path, "home", homeless)
    assert folder() is None
