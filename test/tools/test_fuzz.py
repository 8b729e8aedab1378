"""The kept corpus of the fuzz targets: what once failed stays mended.

The firmware's targets are built with sanitizers; those of the emulator are linked with the library of the
release build, which is as users have it. `make fuzz` has sanitizers for all.
"""

import subprocess
from pathlib import Path

import pytest

from fuzz.build import CORPUS, SUITES, TARGETS, Suite, build
from support.avr import INSIDE_OPTIONS, build_inside

SANITIZED, RELEASE = SUITES


@pytest.fixture(scope="module")
def replays(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The program of each suite, by its name."""
    folder = tmp_path_factory.mktemp("fuzz")
    programs = {suite.name: folder / suite.name for suite in SUITES}
    build(
        "g++",
        SANITIZED,
        "replay.cpp",
        programs[SANITIZED.name],
        "-fsanitize=address,undefined",
    )
    program = programs[RELEASE.name]
    build("g++", RELEASE, "replay.cpp", program, *INSIDE_OPTIONS, library=build_inside())
    return programs


def replay(program: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([program, *words], capture_output=True, text=True, check=False)


def test_each_target_has_a_corpus() -> None:
    assert sorted(folder.name for folder in CORPUS.iterdir()) == sorted(TARGETS)


@pytest.mark.parametrize(
    ("suite", "target"),
    [(suite, target) for suite in SUITES for target in suite.targets],
    ids=lambda value: value if isinstance(value, str) else value.name,
)
def test_a_target_passes_on_all_of_its_corpus(suite: Suite, target: str, replays: dict[str, Path]) -> None:
    files = sorted(map(str, (CORPUS / target).iterdir()))
    assert len(files) >= 5
    done = replay(replays[suite.name], target, *files)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == files


def test_every_field_of_a_snapshot_that_is_wrong_is_refused_or_harmless(
    replays: dict[str, Path], tmp_path: Path
) -> None:
    files = []
    for place in range(0, 1 << 16, 509):  # a prime: they spread over all that a snapshot has
        for number, wrong in enumerate((b"\xff" * 8, b"\x00" * 8, b"\xff" * 7 + b"\x7f")):
            file = tmp_path / f"{place:05}-{number}"
            file.write_bytes(bytes([place % 4]) + place.to_bytes(2, "little") + b"\x07" + wrong)
            files.append(str(file))
    done = replay(replays["emulator"], "snapshots", *files)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == files


def test_a_target_that_is_not_there_and_a_file_that_is_not_there_are_told(replays: dict[str, Path]) -> None:
    cases = (
        ("firmware", ("all", "x"), "TARGET is frames"),
        ("firmware", ("snapshots", "x"), "TARGET is frames"),
        ("emulator", ("frames", "x"), "TARGET is snapshots"),
        ("emulator", ("images", "no-such-file"), "cannot be read"),
    )
    for suite, words, said in cases:
        done = replay(replays[suite], *words)
        assert done.returncode == 2
        assert said in done.stderr
