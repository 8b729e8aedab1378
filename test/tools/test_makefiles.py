"""The libraries' build, wherever the clone is."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from setup import native
from support.alone import alone
from support.avr import build_target
from tilenca.base import paths

PIO = Path(sys.executable).with_name("pio")


NEEDED = ("CMakeLists.txt", "CMakePresets.json", "firmware", "tools")


def cmake(*arguments: str | Path, folder: Path) -> None:
    command = ["cmake", *map(str, arguments)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("generator", "target", "product"),
    [
        ("Ninja", "tilenca_rollout", "libtilenca_rollout.so"),
        ("Unix Makefiles", "rollout_api", "tools/rollout_kernel/CMakeFiles/rollout_api.dir/api.cpp.o"),
    ],
)
def test_a_clone_may_lie_in_a_folder_with_a_blank_in_its_name(
    generator: str, target: str, product: str, tmp_path: Path
) -> None:
    clone = tmp_path / "my tiles"
    clone.mkdir()
    for name in NEEDED:
        source = paths.ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, clone / name)
    quickly = "-DCMAKE_CXX_FLAGS_DEBUG=-O0"
    cmake("--preset", "debug", "-G", generator, quickly, folder=clone)
    cmake("--build", "--preset", "debug", "--target", target, folder=clone)
    assert (clone / "build" / "debug" / product).is_file()


def test_what_is_up_to_date_is_not_built_again() -> None:
    build_target("tilenca_emulator")
    build_target("tilenca_simulator")
    build = paths.BUILD / "release"
    libraries = sorted(build.glob("libtilenca_*.so"))
    before = [library.stat().st_mtime_ns for library in libraries]
    native.build_libraries(["demo"])
    assert before == [library.stat().st_mtime_ns for library in libraries]
    assert len(libraries) >= len(native.LIBRARIES["demo"])


def test_a_clone_that_was_moved_is_configured_anew(tmp_path: Path) -> None:
    build = tmp_path / "build"
    assert native.configured_for(build) is None
    build.mkdir()
    (build / "CMakeCache.txt").write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={tmp_path}/my tiles\n")
    assert native.configured_for(build) is None  # nothing to build by
    (build / "build.ninja").touch()
    assert native.configured_for(build) == tmp_path / "my tiles"
    (build / "CMakeCache.txt").write_bytes(b"\xff\xfe")
    assert native.configured_for(build) is None
    assert native.configured_for(native.BUILD) == paths.ROOT


@pytest.mark.skipif(not PIO.exists(), reason="PlatformIO is not installed; run `make setup`")
def test_the_core_builds_for_this_machine_without_its_tests() -> None:
    command = [str(PIO), "run", "-s", "-d", str(paths.ROOT), "-e", "native"]
    with alone("pio"):
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
