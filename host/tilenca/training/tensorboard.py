"""TensorBoard's event files of a training, where that package is there; nothing else needs it."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from tilenca.base.errors import UsageError
from tilenca.training.progress import Progress, Tell

if TYPE_CHECKING:
    pass

FOLDER = "tensorboard"


def check_tensorboard() -> None:
    """Refuses to write event files without the package.

    Raises:
        UsageError: it is not installed.
    """
    if find_spec("tensorboard") is None:
        raise UsageError("--tensorboard: the package is not installed; run: pip install tensorboard")


@contextmanager
def event_files(folder: Path, tell: Tell) -> Iterator[Tell]:
    """Passes progress on, and writes it into event files below `folder`, each seed in a folder of its own.

    Loss and agreement come with each report, the targets that are held and the shortfall of the others with
    each measurement. A run that goes on replaces what an interrupted one wrote after its checkpoint.
    """
    from torch.utils.tensorboard import SummaryWriter

    writers: dict[int, SummaryWriter] = {}
    checks: dict[int, tuple[int, int, float] | None] = {}

    def write(news: Progress) -> None:
        tell(news)
        at = news.iteration
        if news.seed not in writers:
            writers[news.seed] = SummaryWriter(str(folder / FOLDER / f"seed-{news.seed}"), purge_step=at)
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
