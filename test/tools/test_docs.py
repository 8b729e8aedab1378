"""The documentation's own tools: pages from parsers and docstrings, and the check of the built links."""

import argparse
import ast
import re
from pathlib import Path

import pytest

from docs import command_pages, docstrings, links, module_pages
from tilenca.base import paths
from tilenca.cli import COMMANDS

PAGES = paths.ROOT / "docs" / "reference" / "python"
PACKAGE = paths.ROOT / "host" / "tilenca"
ROOMS = sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))


def test_the_reference_has_every_option_of_every_command() -> None:
    text = command_pages.rendered()
    for command in COMMANDS:
        assert f"\ntilenca {command}\n---" in f"\n{text}"
        for action in command_pages.command_parser(command)._actions:
            for option in action.option_strings if action.help != argparse.SUPPRESS else ():
                assert f"{option}" in text
    assert ".. option:: --shape NAME" in text
    assert ".. option:: -h, --help" in text


def test_help_text_is_not_taken_for_markup() -> None:
    assert (
        command_pages._prose("use `tilenca monitor` on *_x | y") == r"use ``tilenca monitor`` on \*\_x \| y"
    )


def test_values_are_shown_as_in_the_help() -> None:
    parser = command_pages.command_parser("evaluate")
    shown = {action.dest: command_pages._value(action) for action in parser._actions}
    assert shown["shapes"] == "F [F ...]"
    assert shown["engine"] == "{fast,float,emulator}"
    assert shown["json"] == ""


@pytest.mark.parametrize("room", ROOMS)
def test_every_room_has_a_page(room: str) -> None:
    page = (PAGES / f"{room}.rst").read_text(encoding="utf-8")
    assert f".. tilenca-modules:: tilenca.{room}\n" in page
    assert f"python/{room}\n" in PAGES.with_suffix(".md").read_text(encoding="utf-8")


def test_a_page_has_every_module_of_its_room() -> None:
    text = module_pages.rendered("tilenca.shapes")
    modules = [path.stem for path in (PACKAGE / "shapes").glob("*.py") if path.stem != "__init__"]
    assert len(modules) > 3
    for module in modules:
        assert f".. automodule:: tilenca.shapes.{module}\n" in f"{text}\n"
    with pytest.raises(ValueError, match="no package"):
        module_pages.modules("tilenca.shapes.file")


def test_a_colon_of_prose_survives_napoleon() -> None:
    lines = ["The lit segments: a to g.", "", "Returns:", "    The model: its weights.", "    b: c"]
    docstrings.hide_colons("property", lines)
    assert ":" not in lines[0]
    assert ":" not in lines[3]
    assert lines[4] == "    b: c"
    docstrings.show_colons(lines)
    assert lines[0] == "The lit segments: a to g."
    function = ["Adds: two numbers."]
    docstrings.hide_colons("function", function)
    assert function == ["Adds: two numbers."]


def test_a_signature_with_a_factory_is_valid_python() -> None:
    signature = docstrings.valid_signature("(links: dict[str, int] = <factory>, at: tuple[int, int]=(0, 0))")
    assert signature == "(links: dict[str, int] = ..., at: tuple[int, int]=(0, 0))"
    ast.parse(f"def f{signature}: pass")


def test_a_type_variable_needs_no_entry() -> None:
    assert docstrings.is_type_variable("tilenca.emulator.side_by_side.Job")
    assert not docstrings.is_type_variable("tilenca.emulator.array.Array")
    assert not docstrings.is_type_variable("no_such_module.Job")
    assert not docstrings.is_type_variable("Job")


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ('<a href="there.html">x</a>', "there is no such file"),
        ('<a href="other.html#nowhere">x</a>', "no such anchor"),
        ('<a href="#nowhere">x</a>', "no such anchor"),
        ('<img src="picture.png">', "there is no such file"),
        ('<script src="https://example.org/x.js"></script>', "must work offline"),
        ('<link rel="stylesheet" href="//example.org/x.css">', "must work offline"),
    ],
)
def test_a_bad_link_is_found(body: str, complaint: str, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(body, encoding="utf-8")
    (tmp_path / "other.html").write_text('<h1 id="here">x</h1>', encoding="utf-8")
    (found,) = links.faults(tmp_path)
    assert found.startswith("index.html: ")
    assert complaint in found
    assert links.main([str(tmp_path)]) == 1


def test_good_links_are_let_be(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(
        '<h1 id="top"></h1><a href="sub/page.html#here">x</a><a href="#top">x</a>'
        '<a href="https://example.org/">elsewhere</a><img src="data:image/png;base64,AA">',
        encoding="utf-8",
    )
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "page.html").write_text('<a name="here"></a><a href="../index.html">x</a>', "utf-8")
    assert links.main([str(tmp_path)]) == 0
    assert links.main([str(tmp_path / "none")]) == 2


def test_code_that_a_reader_types_has_a_button_that_copies_it_and_output_has_none() -> None:
    configuration = (paths.ROOT / "tools" / "docs" / "conf.py").read_text(encoding="utf-8")
    assert '"sphinx_copybutton",' in configuration
    [typed] = re.findall(r"^TYPED = \((.*)\)$", configuration, re.MULTILINE)
    pages = [paths.ROOT / "README.md", *(paths.ROOT / "docs").rglob("*.md")]
    fences = [
        line for page in pages for line in page.read_text(encoding="utf-8").splitlines() if line[:3] == "```"
    ]
    languages = {fence[3:] for fence in fences if fence[3:].isalpha()}
    assert set(re.findall(r'"(\w+)"', typed)) == languages - {"text"}
