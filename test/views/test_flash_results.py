"""What became of each board, as a table and as a document."""

import json
from dataclasses import replace

import pytest

from support.scripted_port import HELLO
from tilenca.fleet.identify import Answer
from tilenca.views.flash_results import FlashRow, tell


def rows() -> list[FlashRow]:
    flashed = FlashRow("/dev/ttyACM0", seconds=4.25, tile=3, board="serial:1", attempts=1)
    flashed.end("flashed")
    skipped = FlashRow("/dev/ttyACM1")
    skipped.end("skipped")
    skipped.hear(Answer(HELLO))
    failed = FlashRow("/dev/ttyACM2", attempts=2, seconds=11.0)
    failed.end("failed", "no reply; is it a tile?")
    return [flashed, skipped, failed]


def test_the_table_has_a_line_for_each(capsys: pytest.CaptureFixture[str]) -> None:
    tell(rows(), as_json=False)
    said = capsys.readouterr()
    assert [line.split() for line in said.out.splitlines()] == [
        ["PORT", "TILE", "RESULT", "SECONDS", "FIRMWARE", "WHY"],
        ["/dev/ttyACM0", "3", "flashed", "4.2", "-"],
        ["/dev/ttyACM1", "7", "skipped", "-", "ABCDEF01", "runs", "this", "image", "already"],
        ["/dev/ttyACM2", "-", "failed", "11.0", "-", "no", "reply;", "is", "it", "a", "tile?"],
    ]
    assert said.err == "1 of 3 flashed, 1 ran it already\n"


def test_the_document_has_the_same_and_is_one(capsys: pytest.CaptureFixture[str]) -> None:
    tell(rows(), as_json=True)
    document = json.loads(capsys.readouterr().out)
    assert [(tile["result"], tile["error"], tile["firmware_id"]) for tile in document["tiles"]] == [
        ("flashed", None, None),
        ("skipped", None, "ABCDEF01"),
        ("failed", "no reply; is it a tile?", None),
    ]


def test_without_boards_the_document_is_empty_and_nothing_else_is_said(
    capsys: pytest.CaptureFixture[str],
) -> None:
    tell([], as_json=True)
    assert json.loads(capsys.readouterr().out) == {"tiles": []}
    tell([], as_json=False)
    assert capsys.readouterr() == ("", "")


def test_a_board_that_is_never_reached_was_interrupted() -> None:
    assert FlashRow("/dev/ttyACM0").cells[2:] == ["interrupted", "-", "-", "interrupted; flash it again"]


def test_the_file_of_tiles_counts_more_than_what_a_tile_calls_itself() -> None:
    row = FlashRow("/dev/ttyACM0", tile=3)
    row.hear(Answer(HELLO))
    assert (row.tile, row.firmware_id) == (3, "ABCDEF01")
    unnamed = FlashRow("/dev/ttyACM0")
    unnamed.hear(Answer(replace(HELLO, tile=0)))
    assert unnamed.tile is None
    unnamed.hear(Answer(problem="says nothing"))
    assert unnamed.firmware_id == "ABCDEF01"
