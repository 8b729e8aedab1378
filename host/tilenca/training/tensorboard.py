"""TensorBoard's event files of a training, where that package is there; nothing else needs it."""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.training.progress import Progress, Tell

FOLDER = "tensorboard"


def check_tensorboard() -> None:
    """Refuses to write event files without the package.

    Raises:
        UsageError: it is not installed.
    """
    if find_spec("tensorboard") is None:
        raise UsageError("--tensorboard: the package is not installed; run: pip install tensorboard")


@contextmanager
def event_files(folder: Path, began: str, tell: Tell) -> Iterator[Tell]:
    """Passes progress on, and writes it into event files below `folder`.

    Each seed has a folder, and in it each session, by when it `began`, see `Session`.

    Loss and agreement come with each report, the targets that are held and the shortfall of the others with
    each measurement.
    """
    from torch.utils.tensorboard import SummaryWriter

    writers: dict[int, SummaryWriter] = {}
    checks: dict[int, tuple[int, int, float] | None] = {}

    def write(news: Progress) -> None:
        tell(news)
        if news.rows is not None:
            return  # a measurement is at work, and nothing was trained meanwhile
        at = news.iteration
        if news.seed not in writers:
            place = folder / FOLDER / f"seed-{news.seed}" / _name(began)
            writers[news.seed] = SummaryWriter(str(place))
        writer = writers[news.seed]
        writer.add_scalar("loss per tile", news.loss, at)
        writer.add_scalar("share of drawings with every tile right", news.agreement, at)
        if news.check is not None and news.check != checks.get(news.seed):
            checks[news.seed] = news.check
            held, asked, shortfall = news.check
            writer.add_scalar("share of targets held", held / max(asked, 1), at)
            writer.add_scalar("short of the other targets", shortfall, at)

    try:
        yield write
    finally:
        for writer in writers.values():
            writer.close()


def move_events(folder: Path, to: Path, began: Sequence[str]) -> None:
    """Moves the event files of the sessions that `began` then to another model's folder."""
    for name in map(_name, began):
        for place in (folder / FOLDER).glob(f"seed-*/{name}"):
            target = to / FOLDER / place.parent.name
            target.mkdir(parents=True, exist_ok=True)
            shutil.move(place, target / name)


def _name(began: str) -> str:
    """A session's time as the name of a folder, on any system."""
    return began.removesuffix("+00:00").replace(":", "-")
