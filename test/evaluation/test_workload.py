"""How much there is to compute is counted without computing it."""

from dataclasses import replace
from pathlib import Path

import pytest

from tilenca.base import paths
from tilenca.evaluation.evaluator import Evaluator
from tilenca.evaluation.suites import Aims, make_suite
from tilenca.evaluation.workload import work_of
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_training_task
from tilenca.simulator.engine import FastEngine
from tilenca.simulator.simulator import Simulator, Trajectory


@pytest.mark.parametrize("model_name", ["digits", "damage"])
def test_the_count_is_near_what_the_measurements_compute(
    model_name: str, two_shapes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = load_model(paths.MODELS / model_name)
    engine, aims = FastEngine(model), Aims(1.5, True, True, directions=model.dimensions.directions > 0)
    task, sizes = load_training_task([two_shapes], 1.5, 20)
    suite = make_suite(replace(task, labels=model.labels), sizes, model.labels, aims, 1)
    assert bool(suite.missing) == aims.directions
    computed = 0
    run = Simulator.run

    def counted(simulator: Simulator, steps: int) -> Trajectory:
        nonlocal computed
        computed += simulator.cells * steps
        return run(simulator, steps)

    with monkeypatch.context() as patch:
        patch.setattr(Simulator, "run", counted)
        work = work_of(engine, suite, 2)
        assert computed == 0
        rows = list(Evaluator(engine, suite, 2, 1).rows())
    assert len(rows) > 20
    assert work.updates == pytest.approx(computed, rel=0.2)
    assert work.rows == pytest.approx(len(rows), rel=0.2)
