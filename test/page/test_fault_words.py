"""A fault in words is of a place on the board: it stays the same when tiles before it are taken out."""

from pathlib import Path

from support.page_node import PageNode

SCRIPT = """
import { faultWords } from "./stream/faults.js";
const answer = ([fault, places]) => faultWords(fault, places.map((place) => ({ place })));
"""
COLUMN = [[row, 1] for row in range(7)]


WORDS = {
    "cut@6S": "a cut cable at row 6, column 2, south",
    "cut@1-2:0.1-0.4": "a cut cable at row 1, column 2 to row 2, column 2, 0.1-0.4 s",
    "off@7": "no power at row 7, column 2",
    "skew=5000@2": "a clock too fast (ppm) 5000 at row 2, column 2",
    "flip=0.01": "flipped bits 0.01 everywhere",
    "off@99": "no power at tile 99",
}


def test_a_fault_is_said_by_its_place_and_not_by_a_number(tmp_path: Path) -> None:
    with PageNode(tmp_path, SCRIPT) as page:
        assert {fault: page.ask([fault, COLUMN]) for fault in WORDS} == WORDS
        assert page.ask(["cut@5S", COLUMN[1:]]) == WORDS["cut@6S"]
