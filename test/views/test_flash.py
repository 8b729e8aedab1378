"""What a person sees while boards are programmed."""

from tilenca.views.flash import ending


def test_on_a_narrow_terminal_boards_are_told_apart_by_the_end_of_their_names() -> None:
    titles = [f"/tmp/a-long-folder-name-of-a-port/tile-{number} tile {number}" for number in (1, 2)]
    shown = [ending(title, 20) for title in titles]
    assert [line[-14:] for line in shown] == ["/tile-1 tile 1", "/tile-2 tile 2"]
    assert {len(line) for line in shown} == {20}
    assert ending("ttyACM3", 0) == "ttyACM3"
