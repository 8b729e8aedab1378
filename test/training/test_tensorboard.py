"""Event files, as TensorBoard itself reads them."""

import importlib.util
from pathlib import Path

import pytest

from support.training import train
from tilenca.training import tensorboard
from tilenca.training.progress import Progress
from tilenca.training.tensorboard import FOLDER, event_files

HERE = importlib.util.find_spec("tensorboard") is not None
needs_it = pytest.mark.skipif(not HERE, reason="the package tensorboard is not installed")


def scalars(folder: Path, tag: str) -> list[tuple[int, float]]:
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(folder))
    events.Reload()
    return [(event.step, event.value) for event in events.Scalars(tag)]


@needs_it
def test_every_report_is_passed_on_and_written_and_a_measurement_once(tmp_path: Path) -> None:
    told: list[Progress] = []
    with event_files(tmp_path, told.append) as tell:
        for news in (
            Progress(1, 10, 0.5, 0.25, None),
            Progress(1, 20, 0.25, 0.5, (3, 4, 0.125)),
            Progress(1, 30, 0.125, 0.75, (3, 4, 0.125)),
            Progress(2, 10, 1.0, 0.0, None),
        ):
            tell(news)
    assert [(one.seed, one.iteration) for one in told] == [(1, 10), (1, 20), (1, 30), (2, 10)]
    first = tmp_path / FOLDER / "seed-1"
    assert scalars(first, "loss per tile") == [(10, 0.5), (20, 0.25), (30, 0.125)]
    assert scalars(first, "share of drawings with every tile right") == [(10, 0.25), (20, 0.5), (30, 0.75)]
    assert scalars(first, "share of targets held") == [(20, 0.75)]
    assert scalars(first, "short of the other targets") == [(20, 0.125)]
    assert scalars(tmp_path / FOLDER / "seed-2", "loss per tile") == [(10, 1.0)]


@needs_it
def test_a_run_that_goes_on_replaces_what_came_after_its_checkpoint(tmp_path: Path) -> None:
    for steps in ((10, 20, 30), (20, 40)):
        with event_files(tmp_path, lambda news: None) as tell:
            for step in steps:
                tell(Progress(1, step, step / 100, 0.0, None))
    found = [step for step, _ in scalars(tmp_path / FOLDER / "seed-1", "loss per tile")]
    assert found == [10, 20, 40]


@needs_it
def test_training_writes_them_if_asked(two_shapes: Path, tmp_path: Path) -> None:
    assert train(two_shapes, tmp_path, "--tensorboard") == 0
    assert scalars(tmp_path / FOLDER / "seed-5", "loss per tile")[-1][0] == 40


def test_without_the_package_the_option_is_refused_before_training(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tensorboard, "find_spec", lambda name: None)
    assert train(two_shapes, tmp_path / "out", "--tensorboard") == 2
    assert "not installed; run: pip install tensorboard" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
