"""Drawings side by side in the terminal."""

from tilenca.views.drawings import half_blocks, side_by_side

FOUR = ("#..#", "#..#", "####", "...#", "...#")
ONE = ("#", "#", "#")


def test_two_rows_of_tiles_are_one_line() -> None:
    assert half_blocks(FOUR) == ["█  █", "▀▀▀█", "   ▀"]
    assert half_blocks(ONE) == ["█", "▀"]


def test_drawings_stand_side_by_side_with_their_titles() -> None:
    assert list(side_by_side([("4", FOUR), ("1", ONE)], 80)) == [
        "4      1",
        "█  █   █",
        "▀▀▀█   ▀",
        "   ▀",
        "",
    ]


def test_what_does_not_fit_begins_a_new_row_and_nothing_is_cut() -> None:
    lines = list(side_by_side([("", FOUR)] * 5, 20))
    assert lines.count("") == 2
    assert sum(line.count("█  █") for line in lines) == 5
    assert max(map(len, lines)) <= 20
    assert list(side_by_side([("", ("#" * 30,))], 20)) == ["▀" * 30, ""]
