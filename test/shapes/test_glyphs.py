"""What a 7-segment digit shows, and how it is read back."""

from tilenca.shapes.glyphs import BLANK, DECIMAL_POINT, GLYPHS, colour_of_class, draw, glyph, label_of_glyph


def test_the_ten_digits_differ() -> None:
    assert len({glyph(digit) for digit in "0123456789"}) == 10


def test_a_shown_label_reads_back() -> None:
    for label in GLYPHS:
        assert label_of_glyph(glyph(label), known=(label,)) == label
        assert label_of_glyph(glyph(label) | DECIMAL_POINT, known=(label,)) == label


def test_dark_and_nonsense_displays() -> None:
    assert label_of_glyph(BLANK) == ""
    assert label_of_glyph(DECIMAL_POINT) == ""
    assert label_of_glyph(0b0000001) == "?"


def test_a_drawn_digit_looks_like_itself() -> None:
    assert draw(glyph("4")) == ("   ", "|_|", "  |")
    assert draw(glyph("8")) == (" _ ", "|_|", "|_|")


def test_the_papers_colours_and_dimmer_ones_for_more_classes() -> None:
    assert colour_of_class(4) == (5, 50, 30)
    assert colour_of_class(14) == (2, 17, 10)
    assert len({colour_of_class(index) for index in range(26)}) == 26
