"""docs/ARCHITECTURE.md and its picture name only what exists, and all the rooms."""

import re

import pytest

from tilenca.base import paths

TEXT = (paths.ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8")
PICTURE = (paths.ROOT / "docs" / "images" / "house.svg").read_text(encoding="utf-8")
PACKAGE = paths.ROOT / "host" / "tilenca"
ROOMS = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
# A path in the text begins at one of these.
STARTS = (paths.ROOT, PACKAGE, paths.FIRMWARE / "include", paths.FIRMWARE / "src")

CODE = re.findall(r"(?<!`)`([^`\n]+)`(?!`)", TEXT)
PATHS = sorted(
    {code for code in CODE if re.fullmatch(r"[\w.-]+(/[\w.-]+)*/?", code) and re.search(r"[./]", code)}
)


@pytest.mark.parametrize("path", PATHS)
def test_every_path_exists(path: str) -> None:
    found = [start / path for start in STARTS if (start / path).exists()]
    assert found, f"docs/ARCHITECTURE.md names {path}"
    assert any(place.is_dir() for place in found) or not path.endswith("/")


def test_many_paths_are_found_in_the_text() -> None:
    assert len(PATHS) > 50


def test_picture_and_table_have_exactly_the_rooms() -> None:
    assert set(re.findall(r'class="room"[^>]*>(\w+)<', PICTURE)) == ROOMS
    assert set(re.findall(r"^\| `(\w+)/` \|", TEXT, re.MULTILINE)) >= ROOMS


def test_links_of_other_documents_into_the_package_exist() -> None:
    """What the other documents call `host/...`, `tools/...`, `firmware/...` or `test/...` is there, too."""
    for document in [*paths.ROOT.glob("*.md"), *sorted((paths.ROOT / "docs").rglob("*.md"))]:
        for name in re.findall(
            r"`((?:host|tools|firmware|test|monitor)/[\w./-]+)`", document.read_text("utf-8")
        ):
            assert (paths.ROOT / name).exists(), f"{document.name} names {name}"
