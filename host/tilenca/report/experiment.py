"""What an experiment of the report is: one command of tilenca, and how its result is read and drawn."""

from dataclasses import dataclass
from pathlib import Path

from tilenca.report.rows import Words

SEED = 20_000


@dataclass(frozen=True)
class Experiment:
    """One command.

    Attributes:
        key: its name; the rows' keys begin with it.
        section: one of `tilenca.report.experiments.TITLES`.
        what: in words.
        words: the command's arguments; `{runs}` stands for the number of runs.
        reader: one of `tilenca.report.rows.READERS`.
        runs: of each drawing, in the full report and in the quick one; the quick one leaves out those with 0.
        figure: the figure that draws its rows; none: they are in the table only.
        axis: what that figure draws them along.
        heat: whether it is drawn as heat maps, its first axis to the right and the second one down.
    """

    key: str
    section: str
    what: str
    words: Words
    reader: str
    runs: tuple[int, int]
    figure: str = ""
    axis: str = ""
    heat: bool = False

    def arguments(self, quick: bool) -> Words:
        """The words, with the number of runs."""
        return tuple(word.format(runs=self.runs[quick]) for word in self.words)

    def emulated_model(self, models: Path) -> Path | None:
        """The folder of the model whose firmware `tilenca evaluate` runs; None: it runs none."""
        if "emulator" not in self.words:
            return None
        return models / self.words[self.words.index("--model") + 1]


def evaluation(*words: str) -> Words:
    """The words of `tilenca evaluate`."""
    return with_seed("evaluate", *words)


def with_seed(*words: str) -> Words:
    """The words of a command that takes runs and a seed."""
    return (*words, "--runs", "{runs}", "--seed", f"{SEED}")


def emulation(*words: str) -> Words:
    """The words of `tilenca emulate`."""
    return ("emulate", *words, "--seed", f"{SEED}")


def sweep(*axes: str, model: bool = False) -> Words:
    """The words of `tilenca sweep` on the digits.

    Args:
        axes: to vary.
        model: whether one of them is of models.
    """
    given = tuple(word for axis in axes for word in ("--axis", axis))
    return with_seed("sweep", *given, *(() if model else ("--model", "digits")), "--shapes", "digits")
