"""Simulation and `tilenca evaluate`: schedules, faults, and what the numbers mean."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tilenca import cli
from tilenca.base import paths
from tilenca.evaluation.metrics import convergence_times
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings
from tilenca.shapes.file import load_task
from tilenca.simulator import core_library
from tilenca.simulator.conditions import Conditions
from tilenca.simulator.engine import States
from tilenca.simulator.simulator import Simulator, Trajectory

needs_core = pytest.mark.skipif(
    not core_library.LIBRARY.exists(), reason="run `make setup` to compile the core"
)


class Gossip:
    """An engine that counts: channel 0 has a cell's number of updates, channel 1 its neighbours' as heard."""

    channels, classes = 3, 2

    def seed(self, cells: int) -> NDArray[np.int16]:
        return np.zeros((cells, 3), np.int16)

    def message(self, states: States) -> States:
        return states

    def update(self, states: States, seen: States) -> States:
        new = states.copy()
        new[:, 0] += 1
        new[:, 1] = seen[:, 3::3].sum(axis=1)  # channel 0 of the four neighbours
        return new


def gossip(shape: str, conditions: Conditions, runs: int = 40, seed: int = 3) -> Simulator:
    drawings = load_drawings([paths.DEFAULT_SHAPES])
    number = next(n for n, each in enumerate(drawings.shapes) if each.name == shape)
    return Simulator(Gossip(), drawings, np.full(runs, number), conditions, np.random.default_rng(seed))


def heard_of(simulator: Simulator) -> NDArray[np.int64]:
    """(N,) number of neighbours' updates each cell had heard of at its last update."""
    return simulator.states[:, 1].astype(np.int64)


def test_on_clocks_every_tile_updates_once_per_step_whenever_it_was_switched_on() -> None:
    simulator = gossip("4", Conditions("clock", drift=0.0))
    simulator.run(1)
    first = simulator.states[:, 0].copy()
    simulator.run(20)
    assert (simulator.states[:, 0] - first == 20).all()
    assert first.min() >= 1
    # Switched on within 10 periods: the first tiles are ten updates ahead of the last.
    assert 8 <= first.max() - first.min() <= 11


def test_drift_lets_tiles_count_differently() -> None:
    simulator = gossip("4", Conditions("clock", drift=0.05, boot=0.0))
    simulator.run(200)
    assert 12 <= np.ptp(simulator.states[:, 0]) <= 22


def test_the_papers_sampler_updates_once_per_step_on_average() -> None:
    simulator = gossip("4", Conditions("random"), runs=200)
    simulator.run(30)
    assert 29.5 < simulator.states[:, 0].mean() < 30.5
    assert simulator.states[:, 0].std() == pytest.approx(np.sqrt(60 * 0.25), rel=0.1)


@pytest.mark.parametrize("schedule", ["random", "clock"])
def test_neighbours_are_heard_with_little_delay(schedule: Any) -> None:
    simulator = gossip("1", Conditions(schedule, boot=0.0, drift=0.0))
    simulator.run(50)
    ends = np.isin(simulator.batch.place, [0, 4])
    expected = np.where(ends, 50, 100)
    assert np.abs(heard_of(simulator) - expected).mean() < 8


@pytest.mark.parametrize("schedule", ["random", "clock"])
def test_with_all_messages_lost_nobody_is_heard(schedule: Any) -> None:
    for lost in ("held", "zero"):
        simulator = gossip("8", Conditions(schedule, loss=1.0, lost=lost))
        simulator.run(10)
        assert not heard_of(simulator).any()


def test_a_lost_message_reads_as_the_last_one_or_as_zero() -> None:
    means = {}
    for lost in ("held", "zero"):
        simulator = gossip("1", Conditions("clock", boot=0.0, loss=0.3, lost=lost))
        simulator.run(60)
        means[lost] = heard_of(simulator).mean()
    everything = gossip("1", Conditions("clock", boot=0.0))
    everything.run(60)
    complete = heard_of(everything).mean()
    assert means["held"] > 0.95 * complete
    assert means["zero"] == pytest.approx(0.7 * complete, rel=0.1)


def test_dead_tiles_never_update_are_never_heard_and_are_not_asked() -> None:
    simulator = gossip("0", Conditions("clock", dead=0.4))
    trajectory = simulator.run(15)
    dead = ~simulator.alive
    assert 0.3 < dead.mean() < 0.5
    assert not simulator.states[dead].any()
    lonely = simulator.alive & (np.append(dead, True)[simulator.batch.neighbours]).all(axis=1)
    assert lonely.any()
    assert not heard_of(simulator)[lonely].any()
    # Every living tile of this engine shows class 0, which is right here; dead ones show nothing.
    assert (trajectory.right[-1] == 1.0).all()


def test_a_run_with_every_tile_dead_keeps_one_to_ask() -> None:
    simulator = gossip("1", Conditions("random", dead=1.0))
    assert (np.add.reduceat(simulator.alive, simulator.batch.starts) == 1).all()


def test_a_tile_shows_nothing_before_its_first_update() -> None:
    drawings = load_drawings([paths.DEFAULT_SHAPES])
    zero = next(n for n, shape in enumerate(drawings.shapes) if shape.label == "0")

    class Sleeper(Gossip):
        def update(self, states: States, seen: States) -> States:
            return states  # scores stay equal, so the lowest class, "0", would be shown

    simulator = Simulator(
        Sleeper(), drawings, np.array([zero]), Conditions("random"), np.random.default_rng(1)
    )
    trajectory = simulator.run(20, record=True)
    assert trajectory.shown is not None
    # A random half updates at a time: some have not yet in the first step, and are dark.
    dark = trajectory.shown[0] == -1
    assert 0 < dark.sum() < len(dark)
    assert trajectory.right[0] == pytest.approx(1 - dark.mean())
    assert not trajectory.shown[-1].any()
    assert trajectory.right[-1].tolist() == [1.0]


def test_settled_is_the_first_step_from_which_all_stay_right() -> None:
    right = np.array([[0, 1, 1, 0.5], [1, 1, 0, 1], [1, 1, 1, 0.9]], np.float32)
    assert Trajectory(right).converged_at.tolist() == [2, 1, 3, np.inf]
    assert convergence_times(Trajectory(right).converged_at) == {"median": 2.0, "p95": None}


def evaluate(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    assert cli.main(["evaluate", "--json", *words]) == 0
    return json.loads(capsys.readouterr().out)


@needs_core
def test_the_shipped_model_is_right_on_its_digits_on_all_schedules(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for schedule in ("clock", "listing", "random"):
        report = evaluate(capsys, "--runs", "10", "--steps", "60", "--schedule", schedule)
        assert report["total_agreement"] >= 0.99, report
        assert report["cells_right"] >= report["total_agreement"]
        assert report["total_agreement"] + sum(report["missed"].values()) == pytest.approx(1)
        assert 3 < report["steps_to_agreement"]["median"] < 20
        assert [row["label"] for row in report["per_shape"]] == list("0123456789")
        assert report["per_shape"][1]["grid"] == "\n".join("#####")


@needs_core
def test_float_and_fast_engines_report_the_same_of_a_model_trained_in_the_tiles_arithmetic(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ("--runs", "3", "--steps", "12", "--loss", "0.2", "--lost", "zero")
    reports = [evaluate(capsys, *words, "--engine", engine) for engine in ("fast", "float")]
    assert [report.pop("engine") for report in reports] == ["fast", "float"]
    assert reports[0] == reports[1]


@needs_core
def test_the_same_seed_gives_the_same_report_and_another_one_another(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ("--runs", "4", "--steps", "7")
    one, again, other = (evaluate(capsys, *words, "--seed", seed) for seed in "112")
    assert one == again
    assert one["cells_right"] != other["cells_right"]


@needs_core
def test_evaluating_needs_no_torch() -> None:
    program = (
        "import sys; sys.modules['torch'] = None; from tilenca import cli; "
        "sys.exit(cli.main(['evaluate', '--runs', '1', '--steps', '3', '--json']))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["steps"] == 3


def test_a_label_the_model_does_not_know_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shapes = tmp_path / "letter.toml"
    shapes.write_text('[[shape]]\nlabel = "H"\ngrid = """\n#.#\n###\n#.#\n"""\n')
    assert cli.main(["evaluate", "--shapes", str(shapes)]) == 2
    error = capsys.readouterr().err
    assert "does not know 'H'; it knows: 0 1 2 3 4 5 6 7 8 9" in error


@pytest.mark.parametrize(
    "words",
    [["--loss", "1.5"], ["--dead", "-0.1"], ["--steps", "0"], ["--runs", "0"], ["--seed", "-1"]],
)
def test_values_that_make_no_sense_are_refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["evaluate", *words])
    error = capsys.readouterr().err.strip()
    assert words[0] in error
    assert len(error.splitlines()) == 1


def test_a_model_that_is_nowhere_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "--model", "nowhere"]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


needs_elf = pytest.mark.skipif(
    not paths.FIRMWARE_ELF.exists(), reason="run `make setup` to build the firmware"
)
SMALL_ONE = '[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n#\n"""\n'


@needs_elf
def test_the_emulated_tiles_are_measured_in_the_same_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shapes = tmp_path / "one.toml"
    shapes.write_text(SMALL_ONE)
    report = evaluate(capsys, "--engine", "emulator", "--shapes", str(shapes), "--steps", "20")
    assert report["total_agreement"] == 1.0
    assert report["per_shape"][0]["cells_right"] == 1.0
    assert report["missed"] is None
    assert 1 <= report["steps_to_agreement"]["median"] <= 20


@needs_elf
def test_the_emulated_tiles_agree_when_and_where_the_fast_simulator_does(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["--schedule", "clock", "--steps", "40"]
    fast = evaluate(capsys, "--engine", "fast", "--runs", "200", *words)
    emulated = evaluate(capsys, "--engine", "emulator", "--runs", "1", *words)
    assert emulated["total_agreement"] == fast["total_agreement"] == 1.0
    for simulated, real in zip(fast["per_shape"], emulated["per_shape"], strict=True):
        # At 20 ms a message takes 0.77 periods, in the simulator 0.5 on average; so up to twice the steps.
        least, most = 1, 2 * simulated["steps_to_agreement"]["p95"] + 3
        assert least <= real["steps_to_agreement"]["median"] <= most, real["name"]


@needs_elf
def test_an_image_with_another_model_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = load_model(paths.DEFAULT_MODEL)
    other = {name: array.copy() for name, array in model.integer.items()}
    other["w1"][0, 0] ^= 1
    replace(model, integer=other).save(tmp_path)
    assert cli.main(["evaluate", "--engine", "emulator", "--model", str(tmp_path), "--steps", "1"]) == 4
    assert f"carries model {model.model_id:04X}, not" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--loss", "0.1"], ["--dead", "0.1"], ["--schedule", "random"]])
def test_what_the_emulated_tiles_cannot_be_made_to_do_is_refused(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["evaluate", "--engine", "emulator", *words]) == 2
    assert "tiles as they are" in capsys.readouterr().err


def test_the_suite_repeats_the_numbers_of_the_same_seed(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "--suite", "--model", "digits-40", "--runs", "1", "--seed", "3"]
    assert cli.main([*words, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert cli.main(words) == 0
    table = capsys.readouterr().out
    assert {row["key"] for row in document["metrics"]["rows"]} >= {"drawings", "sizes", "lost", "longevity"}
    for row in document["metrics"]["rows"]:
        assert f"{row['name']}, @{row['steps']}: {row['share']:.4f}" in table


@pytest.mark.parametrize(
    "words",
    [["--size", "9x7"], ["--engine", "float"], ["--dead", "0.1"], ["--loss", "0.1"], ["--steps", "9"]],
)
def test_the_suite_sets_its_own_conditions(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "--suite", *words]) == 2
    assert f"leave {words[0]} out" in capsys.readouterr().err


def test_exam_is_another_name_of_suite_and_not_in_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "--exam", "--loss", "0.1"]) == 2
    assert "--suite sets its own conditions" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        cli.main(["evaluate", "--help"])
    assert "exam " not in capsys.readouterr().out


def test_drawings_are_stretched_to_the_size_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["evaluate", "--size", "7x6", "--runs", "1", "--json"]) == 0
    found = {row["label"]: row["grid"] for row in json.loads(capsys.readouterr().out)["per_shape"]}
    drawn = {shape.label: shape.grid for shape in load_task(paths.SHAPES / "digits-7x6.toml").shapes}
    drawn["1"] = found["1"]  # a line has no width
    assert found == drawn
    assert cli.main(["evaluate", "--size", "2x2", "--runs", "1", "--json"]) == 0
    assert [row["label"] for row in json.loads(capsys.readouterr().out)["per_shape"]] == ["1"]


def test_a_model_brings_its_own_shapes(capsys: pytest.CaptureFixture[str]) -> None:
    report = evaluate(capsys, "--model", str(paths.MODELS / "pentominoes"), "--runs", "1", "--steps", "2")
    assert {row["file"] for row in report["per_shape"]} == {"pentominoes.toml"}


def test_a_drawing_with_more_tiles_than_ids_is_not_emulated(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    shapes, block = tmp_path / "block.toml", "\n".join(["#" * 20] * 20)
    shapes.write_text(f'[[shape]]\nlabel = "0"\ngrid = """\n{block}\n"""\n')
    assert cli.main(["evaluate", "--engine", "emulator", "--shapes", str(shapes)]) == 2
    assert "shape '0' has 400 tiles; the most that ids allow are 255" in capsys.readouterr().err


def test_times_of_simulated_tiles_may_be_others(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--steps", "20", "--runs", "20", "--seed", "3")
    usual = evaluate(capsys, *words)
    assert evaluate(capsys, *words, "--boot-spread", "0.2", "--latency", "0.1-0.9") == usual
    quick, slow, tiles = (
        evaluate(capsys, *words, "--latency", latency) for latency in ("0.1", "0.95", "tiles")
    )
    assert quick["agreed_by_step"][7] > tiles["agreed_by_step"][7] > 0.1
    assert tiles["agreed_by_step"] != slow["agreed_by_step"]
    assert quick["agreed_by_step"][7] > slow["agreed_by_step"][7]
    assert len(usual["agreed_by_step"]) == 20


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--plug", "new"], "add --engine emulator"),
        (["--latency", "soon"], "--latency: 'soon' is neither"),
        (["--engine", "emulator", "--latency", "0.5"], "no --latency"),
        (["--engine", "emulator", "--plug", "new", "--boot-spread", "2"], "leave --boot-spread out"),
        (["--suite", "--boot-spread", "2"], "leave --boot-spread out"),
    ],
)
def test_times_that_mean_nothing_there_are_refused(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["evaluate", *words]) == 2
    assert said in capsys.readouterr().err
