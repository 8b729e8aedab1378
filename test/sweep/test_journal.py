"""The journal: what is in it outlasts crashes and damage."""

from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.base.errors import UsageError
from tilenca.sweep.counts import Counts
from tilenca.sweep.journal import FILE, Journal

ABOUT: dict[str, Any] = {"--seed": 1, "--runs": 4, "--axis": [["loss", "0"]]}
COUNTS = {f"block/{number}": Counts(4, number, 0, 0, 0, 0.1 * number, {7: number}, 99) for number in range(4)}


def write(folder: Path) -> None:
    with closing(Journal(folder, ABOUT, "tilenca sweep")) as journal:
        for key, counts in COUNTS.items():
            journal.add({key: counts})


def read(folder: Path, about: dict[str, Any] = ABOUT) -> dict[str, Counts]:
    with closing(Journal(folder, about, "tilenca sweep")) as journal:
        return journal.counts


def test_what_was_written_is_there(tmp_path: Path) -> None:
    write(tmp_path / "new" / "folder")
    assert read(tmp_path / "new" / "folder") == COUNTS


@given(cut=st.integers(0, 2000))
def test_after_any_cut_what_is_whole_is_there_and_writing_goes_on(
    cut: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("cut")
    write(folder)
    data = (folder / FILE).read_bytes()
    cut = min(cut, len(data))
    (folder / FILE).write_bytes(data[:cut])
    whole = max(0, data[:cut].count(b"\n") - 1)
    assert read(folder) == dict(list(COUNTS.items())[:whole])
    with closing(Journal(folder, ABOUT, "tilenca sweep")) as journal:
        journal.add(COUNTS)
    assert read(folder) == COUNTS


def test_a_damaged_line_is_measured_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path)
    data = (tmp_path / FILE).read_bytes()
    (tmp_path / FILE).write_bytes(data.replace(b'"block/2":{"runs":4', b'"block/2":{"runs":5'))
    assert read(tmp_path) == {key: counts for key, counts in COUNTS.items() if key != "block/2"}
    assert capsys.readouterr().err == f"{tmp_path / FILE}: 1 damaged lines; what they had is measured again\n"


def test_another_sweep_is_not_mixed_in(tmp_path: Path) -> None:
    write(tmp_path)
    with pytest.raises(UsageError) as caught:
        read(tmp_path, ABOUT | {"--seed": 2})
    assert str(caught.value) == (
        f"{tmp_path}: holds a sweep with another --seed; give another --out, or go on with it by: "
        "tilenca sweep"
    )


def test_a_damaged_first_line_is_refused(tmp_path: Path) -> None:
    (tmp_path / FILE).write_text("something else\n")
    with pytest.raises(UsageError, match="its first line is damaged; remove it"):
        read(tmp_path)


def test_two_cannot_write_at_once(tmp_path: Path) -> None:
    with (
        closing(Journal(tmp_path, ABOUT, "tilenca sweep")),
        pytest.raises(UsageError, match="another sweep is writing there"),
    ):
        read(tmp_path)


def test_a_place_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match="give another --out"):
        read(tmp_path / "file")
