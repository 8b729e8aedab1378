"""The fault atlas: one condition after another gets worse until the model fails, and why it does then."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tilenca.report.experiment import Experiment, sweep
from tilenca.report.rows import SHARE, Row

EDGES = "edges"
SIZES = "size=drawn,12x10"
MODELS = "model=paper,digits-40,digits-drawn,digits"
HOLDS = 0.99  # a claim holds where so many of the runs are right
SHARE_OF_RUNS = "Share of the runs with all tiles right"


def _line(key: str, what: str, unit: str, axes: Sequence[str], quick: int = 0, runs: int = 100) -> Experiment:
    has_models = any(axis.startswith("model=") for axis in axes)
    return Experiment(
        f"{EDGES}.{key}",
        EDGES,
        what,
        sweep(*axes, model=has_models),
        "sweep",
        (runs, quick),
        figure=f"{SHARE_OF_RUNS}: {what}",
        axis=unit,
    )


def _heat(key: str, what: str, axes: Sequence[str], runs: int) -> Experiment:
    return Experiment(
        f"{EDGES}.{key}",
        EDGES,
        what,
        sweep(*axes),
        "sweep",
        (runs, 0),
        figure=f"{SHARE_OF_RUNS}: {what}",
        heat=True,
    )


EXPERIMENTS = (
    _line("loss", "messages lost, the last one held", "share of the messages", ("loss=0:0.9:0.1", SIZES), 4),
    _line(
        "lost",
        "a lost message read as the last one, or as zeros",
        "share of the messages",
        ("loss=0:0.9:0.1", "lost=held,zero"),
    ),
    _line(
        "models.loss",
        "messages lost, by model",
        "share of the messages",
        ("loss=0,0.1,0.2,0.3,0.5,0.7,0.9", MODELS),
    ),
    _line("dead", "tiles dead from the beginning", "share of the tiles", ("dead=0:0.3:0.03", SIZES), 4),
    _line(
        "models.dead",
        "tiles dead, by model",
        "share of the tiles",
        ("dead=0,0.03,0.06,0.1,0.15,0.2,0.3", MODELS),
    ),
    _line(
        "stuck",
        "one tile that is stuck after five updates, and goes on sending",
        "tiles of each run",
        ("stuck=0,1", "size=drawn,7x6,12x10"),
    ),
    _line(
        "flip",
        "bits inverted on the cables",
        "share of the bits",
        ("flip=0,0.0001,0.0003,0.001,0.003,0.01", SIZES),
    ),
    _line("boot-spread", "tiles switched on within some seconds", "seconds", ("boot-spread=0:4:0.5", SIZES)),
    _line("ppm", "clocks that differ", "millionths, either way", ("ppm=0:40000:5000", SIZES)),
    Experiment(
        f"{EDGES}.latency",
        EDGES,
        "updates until all tiles are right, by what messages take",
        sweep("latency=0.1,0.3,0.5,0.7,0.9,0.97", SIZES),
        "sweep times",
        (100, 0),
        figure="Updates until all tiles are right, median: what messages take",
        axis="periods",
    ),
    _line(
        "size",
        "larger and larger",
        "places of the drawing",
        ("size=5x4,7x6,9x7,12x10,14x12,16x13,20x16,24x20,30x24",),
        runs=20,
    ),
    _heat(
        "loss-dead",
        "messages lost and tiles dead, at three sizes",
        ("loss=0:0.8:0.2", "dead=0,0.02,0.05,0.1,0.2", "size=drawn,7x6,12x10"),
        30,
    ),
    _heat("loss-size", "messages lost and size", ("loss=0:0.9:0.1", "size=5x4,7x6,9x7,12x10,14x12"), 20),
)


@dataclass(frozen=True)
class HeatMap:
    """A heat map.

    Attributes:
        title: what all its cells have in common; empty where there is one map only.
        across, down: what goes to the right, and down.
        columns: values to the right, as text.
        rows: a value down, as text, and its cells.
    """

    title: str
    across: str
    down: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, tuple[Row, ...]], ...]


def heat_maps(rows: Sequence[Row]) -> list[HeatMap]:
    """The heat maps of an experiment: one for each value of its third axis.

    Args:
        rows: of two or three axes.
    """
    found: dict[str, dict[str, dict[str, Row]]] = {}
    names: list[str] = []
    for row in rows:
        names = list(row.place)
        right, down, *others = row.place.values()
        title = ", ".join(f"{name} {value}" for name, value in zip(names[2:], others, strict=True))
        found.setdefault(title, {}).setdefault(down, {})[right] = row
    return [
        HeatMap(
            title,
            names[0],
            names[1],
            tuple(next(iter(of.values()))),
            tuple((down, tuple(mine.values())) for down, mine in of.items()),
        )
        for title, of in found.items()
    ]


def endings(lines: Mapping[str, Sequence[Row]]) -> Iterator[str]:
    """Where the claim of each line ends: how far all runs but one in a hundred are right.

    Args:
        lines: rows in the order of their values, by the line's name.
    """
    for name, rows in lines.items():
        shares = [(row.across, row.value) for row in rows if row.unit == SHARE and row.value is not None]
        if len(shares) < 2:
            continue
        held = 0
        while held < len(shares) and shares[held][1] >= HOLDS:
            held += 1
        which = f"{name}: " if name else ""
        if held == len(shares):
            yield f"{which}holds up to {_value(shares[-1][0])}, the most that was asked"
            continue
        so_far = f"holds up to {_value(shares[held - 1][0])}" if held else "holds nowhere"
        if held == 1 and not shares[0][0]:
            so_far = "holds without any"
        yield f"{which}{so_far}, {shares[held][1]:.2f} at {_value(shares[held][0])}"


def _value(across: float | None) -> str:
    return "-" if across is None else f"{across:g}"
