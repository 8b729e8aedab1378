"""One experiment: the words of its command."""

from pathlib import Path

from tilenca.report.experiment import SEED, Experiment, emulation, evaluation, sweep

MODELS = Path("models")


def experiment(words: tuple[str, ...]) -> Experiment:
    return Experiment("key", "paper", "what", words, "evaluation", (100, 4))


def test_the_number_of_runs_is_that_of_the_full_or_the_quick_report() -> None:
    one = experiment(evaluation("--steps", "10"))
    assert one.arguments(quick=False) == ("evaluate", "--steps", "10", "--runs", "100", "--seed", f"{SEED}")
    assert "4" in one.arguments(quick=True)


def test_a_sweep_has_all_its_axes_and_the_digits_unless_models_vary() -> None:
    assert sweep("loss=0,1", "dead=0")[:7] == (
        "sweep",
        "--axis",
        "loss=0,1",
        "--axis",
        "dead=0",
        "--model",
        "digits",
    )
    assert "--model" not in sweep("model=a,b", model=True)


def test_it_knows_which_firmware_it_needs_built() -> None:
    words = evaluation("--model", "digits-drawn", "--engine", "emulator")
    assert experiment(words).emulated_model(MODELS) == MODELS / "digits-drawn"
    assert experiment(evaluation("--model", "digits-drawn")).emulated_model(MODELS) is None
    assert experiment(emulation("--updates", "60")).emulated_model(MODELS) is None
