"""`--axis NAME=VALUES`: what it means, and what is refused."""

from decimal import Decimal

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tilenca.base.errors import UsageError
from tilenca.sweep.axes import AXES, EMULATOR, FAST, MAX_VALUES, Axis, parse_axis, points, text_of


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("loss=0:0.6:0.2", (0.0, 0.2, 0.4, 0.6)),
        ("loss=0.05:0.25:0.05", (0.05, 0.1, 0.15, 0.2, 0.25)),  # in decimals: 0.15 is no 0.15000000000000002
        ("loss=0:0.5:0.2", (0.0, 0.2, 0.4)),
        ("loss=0.5", (0.5,)),
        ("loss=0,0.1:0.3:0.1,1", (0.0, 0.1, 0.2, 0.3, 1.0)),
        ("loss=.5,1e-3", (0.5, 0.001)),
        ("stuck=0,1", (0.0, 1.0)),
        ("size=5x4,drawn", ("5x4", "drawn")),
        ("drawings=damaged", ("damaged",)),
        ("model=digits,models/mine=2", ("digits", "models/mine=2")),
        ("boot-spread=0:10:5", (0.0, 5.0, 10.0)),
    ],
)
def test_values_and_ranges(text: str, values: tuple[object, ...]) -> None:
    axis = parse_axis(text)
    assert axis == Axis(text.partition("=")[0], values)  # type: ignore[arg-type]
    assert axis.numeric == isinstance(values[0], float)


@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("", "there is no axis ''; there is: model, "),
        ("los=0", "there is no axis 'los'"),
        ("loss", "no values"),
        ("loss=", "no values"),
        ("loss=two", "'two' is not a number from 0 to 1"),
        ("loss=1.5", "'1.5' is not a number from 0 to 1"),
        ("loss=-0.1", "'-0.1' is not a number from 0 to 1"),
        ("loss=nan", "'nan' is not a number from 0 to 1"),
        ("loss=0,,1", "'' is not a number from 0 to 1"),
        ("loss=0:1", "'0:1' is neither a number nor FROM:TO:STEP"),
        ("loss=0:1:0", "'0:1:0' does not go up"),
        ("loss=1:0:0.1", "'1:0:0.1' does not go up"),
        ("loss=0:1:1e-999", "more than 1000 values"),
        ("loss=0:1:0.0001", "more than 1000 values"),
        ("loss=0.1,0.10", "0.1 is there twice"),
        ("loss=0.1:0.3:0.1,0.2", "0.2 is there twice"),
        ("stuck=0.5", "'0.5' is not a whole number from 0 to 1"),
        ("size=5", "'5' is not a size of 1x1 to 100x100, like 5x4"),
        ("size=5x4,5x4", "5x4 is there twice"),
        ("drawings=nice", "'nice' is none of drawn, damaged, varied, unknown"),
        ("model= digits", "a value is empty or has blanks around it"),
        ("model=a,,b", "a value is empty or has blanks around it"),
    ],
)
def test_refusals_name_the_axis_the_fact_and_an_example(text: str, fact: str) -> None:
    with pytest.raises(UsageError) as caught:
        parse_axis(text)
    said = str(caught.value)
    assert said.startswith(f"--axis '{text}': {fact}")
    assert said.endswith("; for example loss=0:0.6:0.05 or size=5x4,7x6")


LETTERS = st.text("0123456789.,:=-+eExlosdrawnN_ \n\u0663", max_size=24)


def parsed(text: str) -> tuple[Axis | None, str]:
    """The axis, or what was said against it."""
    try:
        return parse_axis(text), ""
    except UsageError as error:
        return None, str(error)


@given(st.one_of(st.text(max_size=30), st.builds("{}={}".format, st.sampled_from(list(AXES)), LETTERS)))
@example("loss=0:1e999:1e999")
@example("ppm=0:9e4:1e-300")
@example("loss=\u0663")
@example("loss=1_0")
def test_any_text_is_an_axis_or_a_line(text: str) -> None:
    axis, said = parsed(text)
    if axis is None:
        assert said.startswith(f"--axis '{text}': ")
        return
    kind = AXES[axis.name]
    assert 1 <= len(axis.values) <= MAX_VALUES
    assert len({text_of(value) for value in axis.values}) == len(axis.values)
    for value in axis.values:
        assert isinstance(value, str) if kind.most is None else 0 <= float(value) <= kind.most
    # What is shown may be given again, and is the same.
    again = parse_axis(f"{axis.name}={','.join(map(text_of, axis.values))}")
    assert list(map(text_of, again.values)) == list(map(text_of, axis.values))


@given(st.integers(0, 500), st.integers(0, 500), st.integers(1, 50))
def test_a_range_has_both_ends_and_no_rounding(first: int, more: int, step: int) -> None:
    texts = [str(Decimal(number) / 1000) for number in (first, first + more, step)]
    axis = parse_axis(f"loss={':'.join(texts)}")
    assert axis.values == tuple(number / 1000 for number in range(first, first + more + 1, step))


def test_points_are_every_combination_with_the_engines_usual_values() -> None:
    axes = [parse_axis("size=5x4,7x6"), parse_axis("loss=0,0.5")]
    found = points(axes, FAST)
    assert [(point["size"], point["loss"]) for point in found] == [
        ("5x4", 0.0),
        ("5x4", 0.5),
        ("7x6", 0.0),
        ("7x6", 0.5),
    ]
    assert found[0].keys() == {name for name, kind in AXES.items() if FAST in kind.default}
    assert found[0]["ppm"] == pytest.approx(10_000)
    assert points([], EMULATOR)[0]["ppm"] == 3000


@pytest.mark.parametrize(
    ("axes", "engine", "fact"),
    [
        (["loss=0", "loss=1"], FAST, "--axis loss: it is there twice"),
        (
            ["delay=1"],
            FAST,
            "--axis delay: engine fast cannot do it; leave it out, or give --engine emulator",
        ),
        (["stuck=1"], EMULATOR, "--axis stuck: engine emulator cannot do it"),
        (["dead=0.1", "stuck=1"], FAST, "together they could leave no tile to ask"),
        (["loss=0:1:0.002", "dead=0:1:0.002"], FAST, "--axis: 251,001 combinations, at most 100,000"),
    ],
)
def test_axes_that_do_not_fit_are_refused(axes: list[str], engine: str, fact: str) -> None:
    with pytest.raises(UsageError, match=fact):
        points([parse_axis(text) for text in axes], engine)


def test_messages_may_not_take_longer_than_the_shortest_period() -> None:
    fits = points([parse_axis("latency=0.5,0.1-0.9,tiles"), parse_axis("ppm=0,90000")], FAST)
    assert {point["latency"] for point in fits} == {"0.5", "0.1-0.9", "tiles"}
    with pytest.raises(UsageError, match=r"--axis latency: messages of 0\.95 periods .* --axis ppm"):
        points([parse_axis("latency=0.95"), parse_axis("ppm=60000")], FAST)
    with pytest.raises(UsageError, match=r"at most 0\.98 periods"):
        parse_axis("latency=1.2")
