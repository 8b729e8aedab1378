"""A curve in text."""

from tilenca.views.curve import Curve


def text(curve: Curve, ascii_only: bool = False) -> list[str]:
    return [line.plain for line in curve.lines(ascii_only)]


def test_without_a_value_there_is_nothing_to_draw() -> None:
    assert text(Curve(100, "shares")) == []


def test_each_column_has_the_mean_of_its_part_of_the_course() -> None:
    curve = Curve(100, "shares over 100", width=4, height=2)
    for at, share in ((0, 0.0), (10, 0.5), (30, 0.5), (60, 1.0)):
        curve.add(at, share)
    assert text(curve) == ["100 %│  █", "  0 %│▄██", "     └────", "      shares over 100"]


def test_a_column_without_a_value_has_that_of_the_one_before_and_the_rest_is_to_come() -> None:
    curve = Curve(100, "shares", width=4, height=2)
    curve.add(30, 1.0)  # a run that goes on begins in the middle
    curve.add(99, 0.5)
    assert text(curve)[:2] == ["100 %│███ ", "  0 %│████"]
    curve = Curve(100, "shares", width=4, height=2)
    curve.add(0, 1.0)
    assert text(curve)[0] == "100 %│█"


def test_the_end_of_the_course_is_in_the_last_column_and_old_encodings_get_ascii() -> None:
    curve = Curve(100, "shares", width=2, height=2)
    curve.add(100, 1.0)
    curve.add(10, 0.0)
    lines = text(curve, ascii_only=True)
    assert lines == ["100 %| #", "  0 %| #", "     +--", "      shares"]
    assert all(line.isascii() for line in lines)
