"""The kept corpus of the fuzz targets, under sanitizers: what once failed stays mended."""

import subprocess
from pathlib import Path

import pytest

from fuzz.build import CORPUS, TARGETS, build


@pytest.fixture(scope="module")
def replay(tmp_path_factory: pytest.TempPathFactory) -> Path:
    program = tmp_path_factory.mktemp("fuzz") / "replay"
    build("g++", "replay.cpp", program, "-fsanitize=address,undefined")
    return program


def test_each_target_has_a_corpus_and_passes_on_all_of_it(replay: Path) -> None:
    assert sorted(folder.name for folder in CORPUS.iterdir()) == sorted(TARGETS)
    for target in TARGETS:
        files = sorted(map(str, (CORPUS / target).iterdir()))
        assert len(files) >= 5
        done = subprocess.run([replay, target, *files], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines() == files


def test_a_target_that_is_not_there_and_a_file_that_is_not_there_are_told(replay: Path) -> None:
    for words, said in ((["all", "x"], "TARGET is frames"), (["frames", "no-such-file"], "cannot be read")):
        done = subprocess.run([replay, *words], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert said in done.stderr
