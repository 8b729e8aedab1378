"""What a 7-segment digit shows, and how it is read back."""

import pytest

from tilenca.shapes.glyphs import (
    BLANK,
    DECIMAL_POINT,
    GLYPHS,
    Look,
    draw,
    label_of_glyph,
    look_of,
    look_of_class,
    looks_of,
    screen_colour,
)


def test_the_ten_digits_differ() -> None:
    assert len({GLYPHS[digit] for digit in "0123456789"}) == 10


def test_a_shown_label_reads_back() -> None:
    for label in GLYPHS:
        assert label_of_glyph(GLYPHS[label], known=(label,)) == label
        assert label_of_glyph(GLYPHS[label] | DECIMAL_POINT, known=(label,)) == label


def test_dark_and_nonsense_displays() -> None:
    assert label_of_glyph(BLANK) == ""
    assert label_of_glyph(DECIMAL_POINT) == ""
    assert label_of_glyph(0b0000001) == "?"


def test_a_drawn_digit_looks_like_itself() -> None:
    assert draw(GLYPHS["4"]) == ("   ", "|_|", "  |")
    assert draw(GLYPHS["8"]) == (" _ ", "|_|", "|_|")


def test_the_papers_colours_and_dimmer_ones_for_more_classes() -> None:
    assert look_of("A", 4).colour == (5, 50, 30)
    assert look_of("A", 14).colour == (2, 17, 10)
    assert len({look_of("A", index).colour for index in range(30)}) == 30


def test_a_digit_has_its_own_colour_wherever_it_stands_and_a_letter_that_of_its_class() -> None:
    assert look_of_class(("7", "0"), 0) == look_of_class(tuple("0123456789"), 7)
    assert look_of_class(("b", "7"), 0).colour == look_of_class(("A", "b"), 0).colour
    assert looks_of(("7", "b")) == [Look("7", GLYPHS["7"], (55, 0, 0)), Look("b", GLYPHS["b"], (0, 20, 0))]


def test_a_label_of_a_foreign_tile_lights_nothing_and_harms_nobody() -> None:
    assert look_of("*", 3) == Look("*", BLANK, look_of("A", 3).colour)
    assert look_of("\u0663", 3).segments == BLANK, "a digit of another script is no class of ours"


def test_thirty_classes_have_thirty_colours_on_a_screen() -> None:
    colours = [screen_colour(look_of("A", number).colour) for number in range(30)]
    assert len(set(colours)) == 30
    assert all(0 <= part <= 1 for colour in colours for part in colour)


def test_on_a_screen_dimmer_repetitions_are_darker_and_what_is_off_is_black() -> None:
    first, second, third = (screen_colour(look_of("A", number).colour) for number in (2, 12, 22))
    assert first == pytest.approx((0.3, 0.3, 0.94))
    assert max(first) > max(second) > max(third) > 0
    assert screen_colour((0, 0, 0)) == (0, 0, 0)


def test_a_dimmed_tile_has_its_hue_on_a_screen() -> None:
    """`tilenca set brightness` scales the duty: a screen shows which digit it is all the same."""
    assert screen_colour((0, 0, 15)) == screen_colour((0, 0, 30))
