"""The experiments of the report: the paper's, ours, and where each claim ends.

An experiment is one command of tilenca. What it finds out is read from its JSON, so whoever types the command
gets the same numbers.
"""

from tilenca.report import atlas, words
from tilenca.report.experiment import Experiment, emulation, evaluation, with_seed
from tilenca.report.rows import Words

PAPER, OURS, PLUG, DRAWN, EDGES, GAP = "paper", "ours", "plug", "drawn", atlas.EDGES, "gap"
TITLES = {
    PAPER: "The paper's experiments",
    OURS: "What the shipped model does",
    PLUG: "Tiles plugged in while the others run",
    DRAWN: "Digits as drawn alone",
    EDGES: "The fault atlas: where it ends",
    GAP: "Simulation and tile",
}
INTRODUCTIONS = words.introductions()
SIZES = ("5x4", "7x6", "8x5", "9x7", "12x10", "14x12", "20x16")
STEPS_OF = {"20x16": 200, "5x4": 60, "7x6": 60, "8x5": 60}
NETWORKS = {"paper": "by the paper's recipe", "digits": "shipped model"}
# Rows of the test suite, by parts of their names.
DRAWN_ROWS = (
    "held-out forms",
    "one tile missing, new pairs",
    "no class",
    "connected drawing",
    "at once",
    "every 15 updates",
    "listing",
    "1000",
)
# What both engines are asked; runs of each drawing on emulated tiles, in the full report and the quick one.
GAPS: tuple[tuple[str, str, Words, tuple[int, int]], ...] = (
    ("60", "ten digits after 60 updates", ("--steps", "60"), (50, 1)),
    ("60.3x3", "three by three after 60 updates", ("--shapes", "digits-3x3", "--steps", "60"), (20, 0)),
    ("60.7x6", "ten digits at 7x6 after 60 updates", ("--size", "7x6", "--steps", "60"), (10, 0)),
)
LIKE_TILES = ("--boot-spread", "1", "--latency", "tiles")  # emulated tiles are switched on within a second
LINES_OF_GAP: tuple[tuple[str, str, Words], ...] = (
    ("fast", "simulator, usual times", ()),
    ("timed", "simulator, the tiles' own times", LIKE_TILES),
    ("tiles", "emulated tiles", ("--engine", "emulator")),
)
BY_UPDATE = "Share of the runs in which all tiles are right, update by update"
STATES = ("--check-states", "--bootloader", "none", "--updates", "60")
CONVERGED = "60"  # these must not differ
FIGURE_SHAPES = ("4", "7", "1")  # side by side, as in the paper


EXPERIMENTS = (
    *(
        Experiment(
            f"paper.{model}.listing.{steps}",
            PAPER,
            f"ten digits, {NETWORKS[model]}, the paper's listing, after {steps} updates",
            evaluation("--model", model, "--schedule", "listing", "--steps", f"{steps}"),
            "evaluation",
            (500, 50),
        )
        for model in NETWORKS
        for steps in (10, 30, 60)
    ),
    Experiment(
        "paper.3x3",
        PAPER,
        "three by three, tiles' clocks",
        evaluation("--shapes", "digits-3x3"),
        "evaluation",
        (500, 50),
    ),
    *(
        Experiment(
            f"paper.curve.{shape}",
            PAPER,
            f"'{shape}', the paper's listing",
            with_seed("simulate", "--shape", shape, "--schedule", "listing", "--steps", "30"),
            "curve",
            (1000, 100),
            figure="Share of the tiles that are right, update by update",
            axis="updates",
        )
        for shape in FIGURE_SHAPES
    ),
    *(
        Experiment(
            f"paper.size.{size}",
            PAPER,
            f"ten digits at {size}, tiles' clocks",
            evaluation("--size", size, "--steps", f"{STEPS_OF.get(size, 100)}"),
            "evaluation",
            (200, 10 if size != "20x16" else 2),
        )
        for size in SIZES
    ),
    Experiment(
        "paper.tiles",
        PAPER,
        "ten digits on emulated tiles, an update every 20 ms",
        emulation("--updates", "60"),
        "emulations",
        (1, 1),
    ),
    Experiment(
        "paper.settings",
        PAPER,
        "4, 7 and 1 on emulated tiles with the paper's settings, 2 s and 30 updates",
        emulation(
            *(word for shape in FIGURE_SHAPES for word in ("--shape", shape)),
            "--period-ms",
            "2000",
            "--updates",
            "30",
        ),
        "emulations",
        (1, 0),
    ),
    *(
        Experiment(
            key,
            DRAWN,
            "digits as drawn alone",
            evaluation(
                "--suite", "--model", "digits-drawn", *(word for row in rows for word in ("--row", row))
            ),
            "suite",
            runs,
        )
        for key, rows, runs in (("drawn", DRAWN_ROWS[:1], (100, 2)), ("drawn.more", DRAWN_ROWS[1:], (100, 0)))
    ),
    Experiment(
        "suite", OURS, "the test suite", evaluation("--suite", "--model", "digits"), "suite", (100, 4)
    ),
    *(
        Experiment(
            f"plug.{model}.{kind}",
            PLUG,
            f"{what}, models/{model}, ten digits",
            evaluation("--model", model, "--shapes", "digits", "--engine", "emulator", "--plug", kind),
            "plugging",
            (6, 1 if model == "digits" and kind == "again" else 0),
        )
        for model in ("digits", "digits-drawn")
        for kind, what in (
            ("again", "a tile pulled for 0.8 s and plugged in again"),
            ("new", "a tile plugged in that was never there"),
        )
    ),
    *atlas.EXPERIMENTS,
    *(
        Experiment(
            f"gap.states{key}",
            GAP,
            f"state by state, {what}",
            emulation(*STATES, *given),
            "states",
            (1, quick),
        )
        for key, what, given, quick in (
            ("", "ten digits", (), 0),
            (".4", "the 4", ("--shape", "4"), 1),
            (
                ".loss",
                "ten digits, 5 % of the bytes lost on the cables of tile 1",
                ("--fault", "loss=0.05@1"),
                0,
            ),
            (
                ".cable",
                "the 4, 10 % of the bytes lost on one cable",
                ("--shape", "4", "--fault", "loss=0.1@1-3"),
                0,
            ),
        )
    ),
    *(
        Experiment(
            f"gap.{engine}.{name}",
            GAP,
            f"{what}, {line}",
            evaluation("--model", "digits", *more, *given),
            "agreement" if name == CONVERGED else "evaluation",
            runs if engine == "tiles" else (500, 50 if runs[1] else 0),
            figure=BY_UPDATE if name == CONVERGED else "",
            axis="updates",
        )
        for name, what, more, runs in GAPS
        for engine, line, given in LINES_OF_GAP
        if engine in ("fast", "tiles") or name == CONVERGED
    ),
)


def chosen(quick: bool) -> list[Experiment]:
    """The experiments of a report."""
    return [experiment for experiment in EXPERIMENTS if experiment.runs[quick]]
