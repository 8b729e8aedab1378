"""The source archive has all that the libraries are made of; nothing is compiled for the wheel."""

import tarfile
from pathlib import Path

import pytest

from release import wheel
from release.wheel import WheelError, check_whole, make, read_by_compiler
from setup import native
from tilenca.base import paths


@pytest.fixture(scope="module")
def archive() -> Path:
    return make()[0]


def test_the_compiler_tells_what_it_has_read_of_every_library(archive: Path) -> None:
    assert archive.exists()  # and so the libraries are
    read = read_by_compiler()
    assert {f"tools/{name}/api.cpp" for name in ("simulator", "rollout_kernel")} <= read
    assert {"tools/simulator/cells.h", "tools/c_api/guard.h", "tools/c_api/exports.map"} <= read
    headers = [name for name in read if name.startswith("firmware/include/core/")]
    assert headers
    assert [name for name in read if not (paths.ROOT / name).is_file()] == []
    sources = {
        str(path.relative_to(paths.ROOT)) for path in (paths.ROOT / "tools/emulator/src").rglob("*.cpp")
    }
    assert sources <= read


@pytest.mark.parametrize("missing", ["tools/simulator/cells.h", "tools/c_api/exports.map"])
def test_an_archive_without_one_of_these_files_is_refused(
    missing: str, archive: Path, tmp_path: Path
) -> None:
    check_whole(archive)
    broken = tmp_path / "broken.tar.gz"
    with tarfile.open(archive) as whole, tarfile.open(broken, "w:gz") as less:
        for member in whole.getmembers():
            if not member.name.endswith(missing):
                less.addfile(member, whole.extractfile(member))
    with pytest.raises(WheelError, match=rf"^broken\.tar\.gz: lacks {missing}; see sdist\.exclude"):
        check_whole(broken)


def test_a_build_that_does_not_tell_is_not_believed(tmp_path: Path) -> None:
    for ninja in (False, True):
        if ninja:
            (tmp_path / "build.ninja").touch()
        with pytest.raises(WheelError, match="remove it and run `make setup`"):
            read_by_compiler(tmp_path)


def test_the_makefiles_depfiles_are_read_as_well_where_the_clone_lies_in_a_folder_with_a_blank(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = tmp_path / "my tiles"
    build = root / "build" / "release"
    build.mkdir(parents=True)
    escaped = str(root).replace(" ", "\\ ")
    (build / "a.cpp.o.d").write_text(
        f"a.cpp.o: {escaped}/tools/a.cpp \\\n /usr/include/stdio.h {escaped}/build/b.h\n"
    )
    (build / "gone.cpp.o.d").write_text(f"gone.cpp.o: {escaped}/tools/gone.cpp")
    (root / "tools").mkdir()
    (root / "tools" / "a.cpp").touch()
    monkeypatch.setattr(wheel, "ROOT", root)
    assert read_by_compiler(build) == {"tools/a.cpp", "tools/c_api/exports.map"}


def test_nothing_is_compiled_for_the_wheel(archive: Path) -> None:
    assert archive.exists()
    assert list((wheel.WORK / "cmake").rglob("*.o")) == []
    assert sorted(native.BUILD.glob("libtilenca_*.so"))
