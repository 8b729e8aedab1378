"""The code in the documents is true: it runs as written, or at least its arguments exist."""

import shlex
from pathlib import Path

import pytest

from support.blocks import Block, blocks
from support.reader import Reader, parse
from tilenca.base import paths

DOCS = paths.ROOT / "docs"
# A user follows these from top to bottom.
FOLLOWED = [paths.ROOT / "README.md", *sorted(DOCS.glob("tutorial/*.md")), *sorted(DOCS.glob("how-to/*.md"))]
# The commands of these are only parsed here: docs/FLEET.md has a test of its own with tiles to talk to.
READ = sorted(DOCS.glob("*.md"))


def name(document: Path) -> str:
    return str(document.relative_to(paths.ROOT))


@pytest.mark.parametrize("document", FOLLOWED, ids=name)
def test_every_block_runs_in_the_order_of_the_page(document: Path, firmware: Path, tmp_path: Path) -> None:
    assert firmware.exists()  # the commands run the build of this checkout
    with Reader(tmp_path) as reader:
        for block in blocks(document):
            reader.follow(block)


@pytest.mark.parametrize("document", READ, ids=name)
def test_every_command_is_one_that_exists(document: Path) -> None:
    for block in blocks(document):
        for command in block.commands if block.language == "sh" else ():
            parse(shlex.split(command), block.place)


def block_of(text: str, tmp_path: Path) -> Block:
    page = tmp_path / "page.md"
    page.write_text(text, encoding="utf-8")
    (block,) = blocks(page)
    return block


def test_marks_say_how_a_block_is_tested(tmp_path: Path) -> None:
    marked = block_of("<!-- test: with --runs 2; status 3, no tile -->\n```sh\ntilenca set\n```\n", tmp_path)
    assert (marked.more, marked.status, marked.runs) == (("--runs", "2"), 3, True)
    assert not block_of("<!-- test: parse, needs a tile -->\n```sh\nx\n```\n", tmp_path).runs
    plain = block_of("text\n\n```sh\ntilenca devices\n# why\n\ntilenca set\n```\n", tmp_path)
    assert plain.commands == ["tilenca devices", "tilenca set"]
    assert plain.place == "page.md:3"


@pytest.mark.parametrize(
    "mark", ["<!-- test: skip -->\n", "<!-- test: parse -->\n", "<!-- test: parse, why -->\n\n"]
)
def test_a_mark_that_nobody_understands_is_refused(mark: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="mark for tests"):
        block_of(f"{mark}```sh\ntilenca devices\n```\n", tmp_path)


def test_a_reader_goes_into_a_folder_and_stays_there(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    block = "```python\nfrom pathlib import Path\nassert Path('digits.toml').exists()\n```\n"
    page.write_text(f"```sh\ncd shapes\n```\n\n{block}", encoding="utf-8")
    (tmp_path / "clone").mkdir()
    with Reader(tmp_path / "clone") as reader:
        for part in blocks(page):
            reader.follow(part)
        with pytest.raises(AssertionError, match=r"page\.md:1"):
            reader.follow(next(blocks(page)))  # there is no shapes/shapes


def test_a_block_may_be_a_file(tmp_path: Path) -> None:
    assert block_of("```toml\n# mine.toml: two letters\na = 1\n```\n", tmp_path).file_name == "mine.toml"
    assert block_of("```toml\na = 1\n```\n", tmp_path).file_name is None


@pytest.mark.parametrize(
    "words", [["tilenca", "emulate", "--colour"], ["tilenca", "fly"], ["pio", "run", "-e", "none"], ["rm"]]
)
def test_a_command_that_does_not_exist_is_noticed(words: list[str]) -> None:
    with pytest.raises(AssertionError, match="page"):
        parse(words, "page")
