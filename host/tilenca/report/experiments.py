"""The experiments of the report: the paper's, ours, and where each claim ends.

An experiment is one command of tilenca. What it finds out is read from its JSON, so whoever types the command
gets the same numbers.
"""

from dataclasses import dataclass

from tilenca.report.rows import Words

PAPER, OURS, HANDS, EDGES, GAP = "paper", "ours", "hands", "edges", "gap"
TITLES = {
    PAPER: "The paper's experiments",
    OURS: "What the shipped model does",
    HANDS: "Any hand's digits",
    EDGES: "Where it ends",
    GAP: "Simulation and tile",
}
INTRODUCTIONS = {
    PAPER: "The ten digits of the paper on 5x4 tiles, by the paper's own listing (one tile after another, "
    "drawn with replacement) and on emulated tiles; three by three and seven by six; time to agreement by "
    "size.",
    OURS: "Every row of the test suite of the model card, measured anew. Rows with a target say what was "
    "aimed at, and whether it was reached.",
    HANDS: "What models/digits-hands does, which is trained on what digits may become and not on drawings "
    "alone: forms that it was never shown, and what it pays for them beside the shipped model.",
    EDGES: "One condition after another gets worse until the model fails. A dead tile can cut a drawing into "
    "pieces that cannot talk to each other; then no model could be right in all of the runs. A lost message "
    "leaves the last one in place. Larger drawings need more updates, and beyond the trained sizes nothing "
    "was promised.",
    GAP: "The same drawings and number of updates in the fast simulator, which runs the firmware's own core, "
    "and on emulated tiles, which run the firmware's image with its interrupts, cables and clocks. After 60 "
    "updates they must not differ. After 8 to 12 they do, since messages of emulated tiles take 0.77 of a "
    "period, and those of the simulator 0.1 to 0.9: that is what real timing changes.",
}
SEED = 20_000
SIZES = ("5x4", "7x6", "8x5", "9x7", "12x10", "14x12", "20x16")
STEPS_OF = {"20x16": 200, "5x4": 60, "7x6": 60, "8x5": 60}
NETWORKS = {"paper": "by the paper's recipe", "digits": "shipped model"}
# Rows of the test suite, by parts of their names.
HANDS_ROWS = (
    "held-out forms",
    "one tile missing, new pairs",
    "no class",
    "connected drawing",
    "at once",
    "listing",
    "1000",
)
# What both engines are asked; runs of each drawing on emulated tiles, in the full report and the quick one.
GAPS: tuple[tuple[str, str, Words, tuple[int, int]], ...] = (
    ("60", "ten digits after 60 updates", ("--steps", "60"), (20, 1)),
    ("60.3x3", "three by three after 60 updates", ("--shapes", "digits-3x3", "--steps", "60"), (20, 0)),
    ("60.7x6", "ten digits at 7x6 after 60 updates", ("--size", "7x6", "--steps", "60"), (10, 0)),
    ("12", "ten digits after 12 updates", ("--steps", "12"), (20, 0)),
    ("10", "ten digits after 10 updates", ("--steps", "10"), (20, 0)),
    ("8", "ten digits after 8 updates", ("--steps", "8"), (20, 0)),
)
CONVERGED = "60"  # these must not differ
FIGURE_SHAPES = ("4", "7", "1")  # side by side, as in the paper


@dataclass(frozen=True)
class Experiment:
    """One command.

    Attributes:
        key: its name; the rows' keys begin with it.
        section: one of `TITLES`.
        what: in words.
        words: the command's arguments; `{runs}` stands for the number of runs.
        reader: one of `tilenca.report.rows.READERS`.
        runs: of each drawing, in the full report and in the quick one; the quick one leaves out those with 0.
        figure: the figure that draws its rows; none: they are in the table only.
        axis: what that figure draws them along.
    """

    key: str
    section: str
    what: str
    words: Words
    reader: str
    runs: tuple[int, int]
    figure: str = ""
    axis: str = ""

    def arguments(self, quick: bool) -> Words:
        """The words, with the number of runs."""
        return tuple(word.format(runs=self.runs[quick]) for word in self.words)


def _evaluate(*words: str) -> Words:
    return _with_seed("evaluate", *words)


def _with_seed(*words: str) -> Words:
    return (*words, "--runs", "{runs}", "--seed", f"{SEED}")


def _emulate(*words: str) -> Words:
    return ("emulate", *words, "--seed", f"{SEED}")


def _sweep(axis: str, *words: str) -> Words:
    return _with_seed("sweep", "--axis", axis, *words, "--model", "digits", "--shapes", "digits")


EXPERIMENTS = (
    *(
        Experiment(
            f"paper.{model}.listing.{steps}",
            PAPER,
            f"ten digits, {NETWORKS[model]}, the paper's listing, after {steps} updates",
            _evaluate("--model", model, "--schedule", "listing", "--steps", f"{steps}"),
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
        _evaluate("--shapes", "digits-3x3"),
        "evaluation",
        (500, 50),
    ),
    *(
        Experiment(
            f"paper.curve.{shape}",
            PAPER,
            f"'{shape}', the paper's listing",
            _with_seed("simulate", "--shape", shape, "--schedule", "listing", "--steps", "30"),
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
            _evaluate("--size", size, "--steps", f"{STEPS_OF.get(size, 100)}"),
            "evaluation",
            (200, 10 if size != "20x16" else 2),
        )
        for size in SIZES
    ),
    Experiment(
        "paper.tiles",
        PAPER,
        "ten digits on emulated tiles, an update every 20 ms",
        _emulate("--updates", "60"),
        "emulations",
        (1, 1),
    ),
    Experiment(
        "paper.settings",
        PAPER,
        "4, 7 and 1 on emulated tiles with the paper's settings, 2 s and 30 updates",
        _emulate(
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
            HANDS,
            "digits of any hand",
            _evaluate(
                "--suite", "--model", "digits-hands", *(word for row in rows for word in ("--row", row))
            ),
            "suite",
            runs,
        )
        for key, rows, runs in (("hands", HANDS_ROWS[:1], (100, 2)), ("hands.more", HANDS_ROWS[1:], (100, 0)))
    ),
    Experiment("suite", OURS, "the test suite", _evaluate("--suite", "--model", "digits"), "suite", (100, 4)),
    *(
        Experiment(
            f"edges.{axis.split('=')[0]}",
            EDGES,
            what,
            _sweep(axis, "--axis", "size=drawn,12x10"),
            "sweep",
            (100, quick),
            figure=f"Share of the runs with all tiles right: {what}",
            axis=unit,
        )
        for axis, what, unit, quick in (
            ("loss=0:0.9:0.1", "messages lost, the last one held", "share of the messages", 4),
            ("dead=0:0.3:0.03", "tiles dead from the beginning", "share of the tiles", 4),
            ("flip=0,0.0001,0.0003,0.001,0.003,0.01", "bits inverted on the cables", "share of the bits", 0),
            ("boot-spread=0:4:0.5", "tiles switched on within some seconds", "seconds", 0),
            ("ppm=0:40000:5000", "clocks that differ", "millionths, either way", 0),
        )
    ),
    Experiment(
        "edges.size",
        EDGES,
        "larger and larger",
        _sweep("size=5x4,7x6,9x7,12x10,14x12,16x13,20x16,24x20,30x24"),
        "sweep",
        (20, 0),
    ),
    *(
        Experiment(
            f"gap.{engine}.{name}",
            GAP,
            f"{what}, {words}",
            _evaluate("--model", "digits", *more, *(("--engine", "emulator") if engine == "tiles" else ())),
            "evaluation",
            runs if engine == "tiles" else (500, 50 if runs[1] else 0),
        )
        for name, what, more, runs in GAPS
        for engine, words in (("fast", "in the fast simulator"), ("tiles", "on emulated tiles"))
    ),
)


def chosen(quick: bool) -> list[Experiment]:
    """The experiments of a report."""
    return [experiment for experiment in EXPERIMENTS if experiment.runs[quick]]
