"""The exporter: what it renders, what it refuses, and that it never leaves half a job."""

import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from firmware.synthetic_models import random_network
from tilenca.base import paths
from tilenca.cli import main
from tilenca.model import packing, render
from tilenca.model.file import Dimensions, Model
from tilenca.shapes.glyphs import GLYPHS

SIZE = Dimensions(5, 7, 6)
HEADER, SOURCE = render.TEMPLATES.values()


@pytest.fixture
def model() -> Model:
    return replace(random_network(SIZE, 127, seed=3), labels=("4", "b", "-"))


@pytest.fixture
def model_directory(model: Model, tmp_path: Path) -> Path:
    model.save(tmp_path / "model")
    return tmp_path / "model"


@pytest.fixture
def firmware(tmp_path: Path) -> Path:
    """A firmware folder to render into, with the headers that rendered files include."""
    shutil.copytree(paths.FIRMWARE / "include" / "core", tmp_path / "firmware" / "include" / "core")
    return tmp_path / "firmware"


def run(*arguments: str | Path) -> int:
    return main(["export", *map(str, arguments)])


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_the_committed_files_are_the_shipped_model() -> None:
    assert run("--model", paths.DEFAULT_MODEL, "--check") == 0


def test_report_as_json(
    model: Model, model_directory: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(firmware / HEADER), str(firmware / SOURCE)]
    assert run("--model", model_directory, "--out", firmware, "--json") == 0
    report = json.loads(capsys.readouterr().out)
    weights = sum(17 + 8 * inputs for inputs in (25, 7, 6))  # one pass each
    assert report == {
        "files": files,
        "flash_bytes": weights + 3 * 5,
        "model_id": f"{model.model_id:04X}",
        "outputs_in_16_bits": [0, 0, 0],
        "written": files,
    }
    assert run("--model", model_directory, "--out", firmware, "--json") == 0
    assert json.loads(capsys.readouterr().out)["written"] == []


def test_check_names_what_differs_and_changes_nothing(
    model_directory: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = contents(firmware)
    assert run("--model", model_directory, "--out", firmware, "--check") == 1
    assert contents(firmware) == before
    error = capsys.readouterr().err
    assert str(firmware / HEADER) in error
    assert str(firmware / SOURCE) in error
    assert run("--model", model_directory, "--out", firmware) == 0
    assert run("--model", model_directory, "--out", firmware, "--check") == 0
    with (firmware / SOURCE).open("a") as file:
        file.write("// mine\n")
    capsys.readouterr()
    assert run("--model", model_directory, "--out", firmware, "--check", "--json") == 1
    output = capsys.readouterr()
    assert json.loads(output.out)["differing"] == [str(firmware / SOURCE)]
    assert re.fullmatch(
        r"tilenca: .*model\.cpp: not what .* renders to; run: tilenca export .*\n", output.err
    )


def test_another_model_replaces_rendered_files(model_directory: Path, firmware: Path, tmp_path: Path) -> None:
    replace(random_network(SIZE, 9, seed=4), labels=("1", "2")).save(tmp_path / "other")
    assert run("--model", tmp_path / "other", "--out", firmware) == 0
    assert run("--model", model_directory, "--out", firmware) == 0
    assert run("--model", model_directory, "--out", firmware, "--check") == 0


def test_current_files_are_not_touched(model_directory: Path, firmware: Path) -> None:
    assert run("--model", model_directory, "--out", firmware) == 0
    before = (firmware / SOURCE).stat()
    assert run("--model", model_directory, "--out", firmware) == 0
    assert (firmware / SOURCE).stat().st_mtime_ns == before.st_mtime_ns
    assert (firmware / SOURCE).stat().st_ino == before.st_ino


@pytest.mark.parametrize(
    "edit", [lambda text: text + "\n", lambda text: text.replace("kLayer1", "kLayer0", 1)]
)
def test_a_file_edited_by_hand_is_kept_unless_forced(
    edit: "type[str]", model_directory: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("--model", model_directory, "--out", firmware) == 0
    source = firmware / SOURCE
    source.write_text(edit(source.read_text()))
    (firmware / HEADER).unlink()
    before = contents(firmware)
    capsys.readouterr()
    assert run("--model", model_directory, "--out", firmware) == 4
    assert contents(firmware) == before
    assert f"{source}: was edited by hand; move it away or pass --force" in capsys.readouterr().err
    assert run("--model", model_directory, "--out", firmware, "--force") == 0
    assert run("--model", model_directory, "--out", firmware, "--check") == 0


@pytest.mark.parametrize("content", [b"int mine;\n", b"\xff\xfe binary", b""])
def test_a_foreign_file_is_kept(
    content: bytes, model_directory: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    foreign = firmware / SOURCE
    foreign.parent.mkdir(parents=True)
    foreign.write_bytes(content)
    before = contents(firmware)
    assert run("--model", model_directory, "--out", firmware) == 4
    assert contents(firmware) == before
    assert "pass --force" in capsys.readouterr().err


def test_nothing_is_written_where_a_file_is_in_the_way_of_a_folder(
    model_directory: Path, firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (firmware / "src").write_text("a file, not a folder")
    before = contents(firmware)
    assert run("--model", model_directory, "--out", firmware) == 4
    assert contents(firmware) == before
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize("out", ["nowhere", "a-file"])
def test_a_missing_folder_is_named(
    out: str, model_directory: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a-file").write_text("x")
    assert run("--model", model_directory, "--out", tmp_path / out) == 4
    assert (
        capsys.readouterr().err
        == f"tilenca: {tmp_path / out}: no such folder; give the firmware's folder to --out\n"
    )


def test_a_read_only_folder_is_named(model_directory: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """/proc refuses new files even from root."""
    assert run("--model", model_directory, "--out", "/proc") == 4
    assert re.fullmatch(r"tilenca: /proc/.*: .*; make /proc writable .*\n", capsys.readouterr().err)


def test_a_directory_that_is_no_model_is_a_usage_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("--model", tmp_path) == 2
    assert "model.json" in capsys.readouterr().err


SIZE = Dimensions(5, 7, 6)
HEADER, SOURCE = render.TEMPLATES.values()


def test_the_compiled_files_hold_exactly_the_model(
    model: Model, model_directory: Path, firmware: Path, tmp_path: Path
) -> None:
    """A small program prints what the rendered files hold, and it is read back."""
    assert run("--model", model_directory, "--out", firmware) == 0
    probe = tmp_path / "probe.cpp"
    probe.write_text(
        """
        #include <stdio.h>
        #include "model/model.h"
        using namespace tilenca;
        void print(const Layer& layer) {
            for (int j = 0; j < layer.outputs; ++j) {
                Layer::Row row = layer.row(j);
                for (int i = 0; i < layer.inputs; ++i) printf("%d ", row.next());
            }
            for (int j = 0; j < layer.outputs; ++j) printf("%d ", layer.bias(j));
            for (int j = 0; j < layer.outputs; j += kBlockOutputs) printf("%d ", layer.is_16_bit(j));
            printf("\\n");
        }
        int main() {
            const Model& m = model::kModel;
            print(m.network.hidden1); print(m.network.hidden2); print(m.network.output);
            for (int k = 0; k < m.classes; ++k) {
                const Look look = m.looks[k];
                printf("%c %d %d %d %d\\n", look.label, look.segments, look.red, look.green, look.blue);
            }
            printf("%04X\\n", m.id);
        }
        """
    )
    program = tmp_path / "probe"
    source = firmware / SOURCE
    subprocess.run(
        [
            "g++",
            "-std=c++14",
            "-Wall",
            "-Wextra",
            "-Werror",
            f"-I{firmware}/include",
            probe,
            source,
            "-o",
            program,
        ],
        check=True,
    )
    lines = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    for layer, line in zip((1, 2, 3), lines[:3], strict=True):
        values = np.array(line.split(), dtype=np.int64)
        narrow = np.array([part.is_16_bit for part in packing.blocks(model, layer)])
        expected = [model.integer[f"w{layer}"].ravel(), model.integer[f"b{layer}"], narrow]
        np.testing.assert_array_equal(values, np.concatenate(expected))
    looks = [f"4 {GLYPHS['4']} 5 50 30", f"b {GLYPHS['b']} 0 20 0", f"- {GLYPHS['-']} 0 0 30"]
    assert lines[3:] == [*looks, f"{model.model_id:04X}"]


def test_the_exporter_says_which_sums_have_16_bits(
    model: Model, firmware: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    integer = {
        name: array // 64 if name in ("w2", "b2", "w3", "b3") else array
        for name, array in model.integer.items()
    }
    replace(model, integer=integer).save(tmp_path / "small")
    assert run("--model", tmp_path / "small", "--out", firmware) == 0
    assert "sums of 16 bits: layer 2 0..5, layer 3 0..4; of 24 bits: all others\n" in capsys.readouterr().out
    assert run("--model", tmp_path / "small", "--out", firmware, "--json") == 0
    assert json.loads(capsys.readouterr().out)["outputs_in_16_bits"] == [0, 6, 5]


def test_without_a_project_it_says_how_to_make_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(paths, "PROJECT", None)
    assert run("--model", paths.DEFAULT_MODEL) == 4
    assert "make one: tilenca new DIR" in capsys.readouterr().err


def test_a_model_that_needs_a_longer_period_says_so(
    firmware: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("--model", paths.MODELS / "hex", "--out", firmware) == 0
    said = capsys.readouterr().err
    assert re.search(
        r"note: this model needs a period of \d+ ms, and the firmware's is 20 ms: build with", said
    )
    assert run("--model", paths.DEFAULT_MODEL, "--out", firmware) == 0
    assert "period" not in capsys.readouterr().err


def test_a_build_beside_the_model_leaves_the_projects_firmware_alone(
    model_directory: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    built: list[Path] = []
    monkeypatch.setattr("tilenca.commands.own_firmware.build", lambda out, *_: built.append(out))
    before = contents(paths.FIRMWARE)
    assert run("--model", model_directory, "--build", "--json") == 0
    report = json.loads(capsys.readouterr().out)
    assert report["image"] == str(paths.model_elf(model_directory))
    assert all(Path(file).is_relative_to(model_directory / "firmware") for file in report["files"])
    assert built == [model_directory / "firmware"]
    assert contents(paths.FIRMWARE) == before
    assert run("--model", model_directory, "--build", "--check") == 2
