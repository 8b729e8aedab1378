"""This tree's emulator and one of before are measured on the same tiles, each in a process of its own."""

import json
import subprocess
from pathlib import Path

import pytest

from bench import native_block, reference, web
from support.avr import build_target
from tilenca.base import paths

SHORT = {"warmUpS": 0.02, "measuredS": 0.02, "translated": False}


def test_the_native_block_runs_in_a_process_without_this_environments_tilenca(firmware: Path) -> None:
    build_target("tilenca_emulator")
    measured = reference.native(paths.ROOT / "host", web.case(False) | SHORT, firmware)
    assert 0 < measured["cpuS"] < 60
    ours = native_block.main(str(firmware), {"grid": "##\n.#", **SHORT})
    assert json.loads(json.dumps(ours)).keys() == measured.keys()


def test_a_program_that_fails_is_named(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="No module named"):
        reference.native(tmp_path, web.case(False))


def test_a_clone_without_the_commit_measures_nothing_against_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    subprocess.run(["git", "init", "-q", str(tmp_path / "clone")], check=True)
    monkeypatch.setattr(reference, "ROOT", tmp_path / "clone")
    assert reference.host_of_reference(tmp_path / "built") is None
