"""The numbers of the README are those of the report: each stands in a link to its row of docs/RESULTS.md.

A share that is no row has a link to where it was measured in its line. A model's card has the command of all
of its numbers. `PYTHONPATH=tools python -m docs.claims` puts the rows' values into the links, and names what
lacks a source; `--check` only compares.
"""

import argparse
import re
import sys
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
README, RESULTS = ROOT / "README.md", ROOT / "docs" / "RESULTS.md"
ROW = re.compile(r'^\| <a id="([^"]+)"></a>[^|]*\| ([^|]+) \|', re.MULTILINE)
CARDS = ROOT / "models"
MEASURED = re.compile(r"^## What was measured$(.*?)^## ", re.MULTILINE | re.DOTALL)
SHARE = re.compile(r"(?<![\d.])[01]\.\d+(?![\d.])(?! (?:s|ms|cycles|times)\b)")
SOURCE = re.compile(r"\]\((?:docs|models)/(?!RESULTS)[^)]+\)")  # a page that says how it was measured
VERSION = re.compile(r"version [\d.]+")
AGAIN = re.compile(r"^    (tilenca evaluate --suite .*)$", re.MULTILINE)
CLAIM = re.compile(r"\[([^\]]*)\]\(docs/RESULTS\.md#([^)]+)\)")


def measured(results: str) -> dict[str, str]:
    """The value of each row of the report's Markdown, by its key."""
    return {key: value.strip() for key, value in ROW.findall(results)}


def filled(text: str, values: Mapping[str, str]) -> str:
    """The text with the measured value in each link to a row.

    Raises:
        KeyError: a link leads to no row; it names the key.
    """
    return CLAIM.sub(lambda claim: f"[{values[claim[2]]}](docs/RESULTS.md#{claim[2]})", text)


def unsourced(text: str) -> list[str]:
    """The shares among the README's measurements that neither are a row's nor have a source in their line.

    Args:
        text: of the README.

    Raises:
        ValueError: there is no such section.
    """
    section = MEASURED.search(text)
    if section is None:
        raise ValueError("no section 'What was measured'")
    found = []
    for line in section[1].splitlines():
        rest = VERSION.sub("", CLAIM.sub("", line))
        if not SOURCE.search(line):
            found += [f"{share} in '{line[:60]}'" for share in SHARE.findall(rest)]
    return found


def without_a_command(cards: Path) -> list[str]:
    """The models' cards that do not have one command which measures all of their numbers again."""
    return [
        str(card) for card in sorted(cards.glob("*/README.md")) if len(AGAIN.findall(card.read_text())) != 1
    ]


def main() -> int:
    """Fills the README, or checks it; 1 where a number is not the measured one."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare only")
    check: bool = parser.parse_args().check
    text = README.read_text(encoding="utf-8")
    if lacking := [*unsourced(text), *without_a_command(CARDS)]:
        print("\n".join(f"{claim}: no source" for claim in lacking), file=sys.stderr)
        return 1
    try:
        right = filled(text, measured(RESULTS.read_text(encoding="utf-8")))
    except KeyError as error:
        print(f"{README.name}: links to {error}, which is no row of {RESULTS.name}", file=sys.stderr)
        return 1
    if check and right != text:
        print(
            f"{README.name}: has other numbers than {RESULTS.name}; run it without --check", file=sys.stderr
        )
        return 1
    if not check:
        README.write_text(right, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
