"""Every JSON output has a schema, and is what it says. Those of other tests' commands are checked there."""

import json
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from docs.command_pages import command_parser
from docs.json_pages import rendered
from support.alone import alone
from support.schemas import fits, schemas
from support.sweeps import one_shape
from tilenca.base import paths
from tilenca.cli import COMMANDS, main
from tilenca.report.rows import share

WITHOUT_JSON = {"page"}  # it serves until Ctrl-C


def printed(capsys: pytest.CaptureFixture[str], *words: str, status: int = 0) -> Any:
    capsys.readouterr()
    assert main([*words, "--json"]) == status
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("name", sorted(schemas()))
def test_every_schema_is_one_and_its_example_fits(name: str) -> None:
    schema = schemas()[name]
    Draft202012Validator.check_schema(schema)
    assert schema["$id"] == f"{name}.json"
    assert schema["examples"]
    for example in schema["examples"]:
        assert fits(name, example)
    assert f"\n{name}\n{'-' * len(name)}\n" in f"\n{rendered()}", "the reference has it"


def test_every_command_that_prints_json_has_a_schema() -> None:
    asked = {name for name in COMMANDS if "--json" in command_parser(name)._option_string_actions}
    assert asked == COMMANDS.keys() - WITHOUT_JSON
    assert asked <= schemas().keys()


def test_a_key_that_no_schema_names_is_an_error() -> None:
    document = schemas()["set"]["examples"][0]
    with pytest.raises(AssertionError, match=r"tiles\[0\].*'colour' was unexpected"):
        fits("set", {"tiles": [{**document["tiles"][0], "colour": "red"}]})


def test_drawings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert fits("shapes", printed(capsys, "shapes", "digits"))
    assert fits("shapes", printed(capsys, "shapes", "digits", "--vary", "1"))
    image = pytest.importorskip("PIL.Image")
    picture = image.new("L", (30, 40), 255)
    picture.paste(0, (5, 5, 15, 35))
    picture.save(tmp_path / "block.png")
    assert fits("shapes-image", printed(capsys, "shapes", "--image", str(tmp_path / "block.png")))
    assert fits("new", printed(capsys, "new", str(tmp_path / "mine")))


def test_a_model(
    two_shapes: Path, trained_model: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mine = ("--model", str(trained_model), "--shapes", str(two_shapes))
    assert fits("evaluate", printed(capsys, "evaluate", *mine, "--runs", "2", "--steps", "5"))
    suite = ("--suite", "--row", "=two.toml, converged", "--runs", "2")
    assert fits("evaluate-suite", printed(capsys, "evaluate", *mine, *suite))
    assert fits("simulate", printed(capsys, "simulate", *mine, "--runs", "2", "--steps", "5"))
    assert fits("simulate", printed(capsys, "simulate", *mine, "--shape", "1", "--steps", "5"))
    assert fits("simulate", printed(capsys, "simulate", *mine[:2], "--array", "3x3", "--steps", "5"))
    out = ("--out", str(tmp_path))
    assert fits("plot", printed(capsys, "plot", str(trained_model), *out))
    film = ("--film", str(tmp_path / "1.png"), "--shape", "1", "--steps", "3")
    assert fits("plot-film", printed(capsys, "plot", *mine, *film))
    assert fits("runs", printed(capsys, "runs", str(trained_model), str(paths.MODELS)))
    assert fits("export", printed(capsys, "export", *mine[:2], *out))
    assert fits("export", printed(capsys, "export", *mine[:2], *out, "--check"))
    assert fits("export-plan", printed(capsys, "export", "--plan"))
    for name in ("model", "metrics", "sessions"):
        assert fits(name, json.loads((trained_model / f"{name}.json").read_text(encoding="utf-8")))


@pytest.mark.parametrize("model", sorted(path.parent.name for path in paths.MODELS.glob("*/metrics.json")))
def test_the_models_that_ship_and_their_measurements(model: str) -> None:
    for name in ("model", "metrics"):
        assert fits(name, json.loads((paths.MODELS / model / f"{name}.json").read_text(encoding="utf-8")))


def test_emulated_tiles(firmware: Path, capsys: pytest.CaptureFixture[str]) -> None:
    short = ("--elf", str(firmware), "--seconds", "1.1")
    capsys.readouterr()
    for shapes in (("--shape", "1"), ("--shape", "1", "--shape", "7")):
        main(["emulate", *short, *shapes, "--json"])
        assert fits("emulate", json.loads(capsys.readouterr().out))


def test_tables_of_measurements(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = (
        "sweep",
        "--axis",
        "loss=0,1",
        "--shapes",
        str(one_shape(tmp_path)),
        "--runs",
        "2",
        "--jobs",
        "1",
    )
    with alone("cluster"):
        assert fits("sweep", printed(capsys, *words, "--out", str(tmp_path / "out")))
    row = share("key", "what", 0.5, 10, 1, ("evaluate",))
    assert fits("report", {"rows": [row.as_json()], "files": ["report.html"]})


@pytest.mark.parametrize("value", [1, "some", None])
def test_the_check_is_of_types_too(value: object) -> None:
    with pytest.raises(AssertionError, match=r"\$\.files"):
        fits("new", {"project": "mine", "files": value})
