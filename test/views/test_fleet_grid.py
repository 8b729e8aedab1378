"""Tiles as boxes and as lines: of one size, whatever they say."""

from tilenca.fleet.grid import Cell, Mark
from tilenca.views.fleet_grid import age_text, full, short, small


def test_boxes_and_lines_have_one_size_whatever_the_numbers() -> None:
    for updates in (None, 0, 999, 9999, 10_000, 999_999, 4_294_967_295):
        for age_s in (None, 0.5, 50.0, 5000.0, 1e6, 1e9):
            cell = Cell(255, "8", (1, 2, 3), updates, 0.05, age_s, "silent", {"E": Mark.DEAD})
            grid = {(0, 0): cell, (1, 1): Cell(None)}
            assert {len(line) for line in full(grid, ascii_only=False)[:5]} == {13}
            assert all(line.plain.isascii() for line in full(grid, ascii_only=True))
            assert len(small(grid)[0]) <= 10
    assert (short(12_345), age_text(0.5), age_text(7.2)) == ("12k", "", "7s")
