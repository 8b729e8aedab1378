"""Event files, as TensorBoard itself reads them."""

import importlib.util
import json
from datetime import datetime, tzinfo
from pathlib import Path

import pytest

from support.training import train
from tilenca.training import sessions, tensorboard
from tilenca.training.progress import Progress
from tilenca.training.tensorboard import FOLDER, event_files, move_events

HERE = importlib.util.find_spec("tensorboard") is not None
needs_it = pytest.mark.skipif(not HERE, reason="the package tensorboard is not installed")


BEGAN = [f"2026-11-30T07:51:4{second}+00:00" for second in range(3)]
NAMES = [f"2026-11-30T07-51-4{second}" for second in range(3)]


class Later(datetime):
    """A session that begins then has another second than one of now."""

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> "Later":
        return cls(2100, 1, 1, tzinfo=tz)


def scalars(folder: Path, tag: str) -> list[tuple[int, float]]:
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    events = EventAccumulator(str(folder))
    events.Reload()
    return [(event.step, event.value) for event in events.Scalars(tag)]


@needs_it
def test_every_report_is_passed_on_and_written_and_a_measurement_once(tmp_path: Path) -> None:
    told: list[Progress] = []
    with event_files(tmp_path, BEGAN[0], told.append) as tell:
        for news in (
            Progress(1, 10, 0.5, 0.25, None),
            Progress(1, 20, 0.25, 0.5, (3, 4, 0.125)),
            Progress(1, 30, 0.125, 0.75, (3, 4, 0.125)),
            Progress(2, 10, 1.0, 0.0, None),
        ):
            tell(news)
    assert [(one.seed, one.iteration) for one in told] == [(1, 10), (1, 20), (1, 30), (2, 10)]
    first = tmp_path / FOLDER / "seed-1" / NAMES[0]
    assert scalars(first, "loss per tile") == [(10, 0.5), (20, 0.25), (30, 0.125)]
    assert scalars(first, "share of drawings with every tile right") == [(10, 0.25), (20, 0.5), (30, 0.75)]
    assert scalars(first, "share of targets held") == [(20, 0.75)]
    assert scalars(first, "short of the other targets") == [(20, 0.125)]
    assert scalars(tmp_path / FOLDER / "seed-2" / NAMES[0], "loss per tile") == [(10, 1.0)]


@needs_it
def test_every_session_has_a_folder_and_goes_where_its_model_goes(tmp_path: Path) -> None:
    other = tmp_path / "model-1234"
    for began, steps in zip(BEGAN, ((10, 20, 30), (20, 40), (20,)), strict=True):
        with event_files(tmp_path, began, lambda news: None) as tell:
            for step in steps:
                tell(Progress(1, step, step / 100, 0.0, None))
    move_events(tmp_path, other, BEGAN[1:])
    stays, *gone = (
        [step for step, _ in scalars(folder / FOLDER / "seed-1" / name, "loss per tile")]
        for folder, name in zip((tmp_path, other, other), NAMES, strict=True)
    )
    assert (stays, gone) == ([10, 20, 30], [[20, 40], [20]])
    assert [path.name for path in (tmp_path / FOLDER / "seed-1").iterdir()] == [NAMES[0]]


@needs_it
def test_training_writes_them_if_asked_and_they_are_those_of_the_model_beside_them(
    two_shapes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert train(two_shapes, tmp_path, "--tensorboard") == 0
    (first,) = (tmp_path / FOLDER / "seed-5").iterdir()
    assert scalars(first, "loss per tile")[-1][0] == 40
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    (tmp_path / "metrics.json").write_text(json.dumps(metrics | {"shortfall": -1.0}))  # none is better
    monkeypatch.setattr(sessions, "datetime", Later)
    assert train(two_shapes, tmp_path, "--tensorboard", "--force") == 0
    assert list((tmp_path / FOLDER / "seed-5").iterdir()) == [first]
    (second,) = tmp_path.glob(f"model-*/{FOLDER}/seed-5/*")
    assert scalars(second, "loss per tile")[-1][0] == 40


def test_without_the_package_the_option_is_refused_before_training(
    two_shapes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tensorboard, "find_spec", lambda name: None)
    assert train(two_shapes, tmp_path / "out", "--tensorboard") == 2
    assert "not installed; run: pip install tensorboard" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
