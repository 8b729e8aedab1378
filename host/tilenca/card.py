"""The model card: how a model was made, what it scores, and how to make it again."""

from typing import Any

from tilenca.modelfile import Model
from tilenca.validation import DISTURBED, MARKS, SCHEDULES

_SCHEDULE_NAMES = {"random": "random halves (the paper's sampler)", "clock": "the tiles' own clocks"}


def render_card(model: Model, metrics: dict[str, Any]) -> str:
    """README.md of a model directory.

    Args:
        model: the model.
        metrics: what `tilenca.validation.validate` returned for it.
    """
    size, made = model.dimensions, model.made
    files = ", ".join(f"`{source['file']}`" for source in made["sources"])
    longevity, switches = metrics["longevity"], metrics["switches"]
    lines = [
        f"# Model {model.model_id:04X}: {' '.join(model.labels)}",
        "",
        f"Tells {len(model.labels)} classes apart. State of {size.channels} channels, hidden layers of "
        f"{size.hidden1} and {size.hidden2}, int8 weights, arithmetic of docs/PROTOCOL.md section 4. "
        "`model.json` says what it is, `weights.npz` holds real and integer weights, `metrics.json` every "
        "number below, `history.csv` the course of training.",
        "",
        "## How it was made",
        "",
        f"Recipe `{made['recipe_name']}` ({made['recipe']['iterations']} iterations), seed {made['seed']}, "
        f"trained on {files}, at commit {made['commit']}.",
        "",
        "To make it again, to the byte on the same PyTorch and processor:",
        "",
        f"    {made['command']}",
        "",
        "## What it scores",
        "",
        f"The integer network, {metrics['runs_per_drawing']} runs of every drawing and schedule. A step is "
        "one update per tile; a run counts when *every* tile shows the right class. On the tiles' own clocks "
        "each tile has a fixed phase, a period up to 1 % off and 0.1 to 0.9 periods of latency, and all are "
        "switched on within 10 periods; steps count from the last one.",
        "",
        "| shapes | schedule | " + " | ".join(f"@{mark}" for mark in MARKS) + " | worst drawing @60 |",
        "|---|---|" + "---|" * (len(MARKS) + 1),
    ]
    for source in made["sources"]:
        for schedule in SCHEDULES:
            row = metrics["agreement"][schedule][source["file"]]
            cells = " | ".join(f"{row[str(mark)]:.3f}" for mark in MARKS)
            worst = f"`{row['worst']['shape']}` {row['worst']['agreement']:.3f}"
            lines.append(f"| `{source['file']}` | {_SCHEDULE_NAMES[schedule]} | {cells} | {worst} |")
    lines += ["", "| on the tiles' own clocks | |", "|---|---|"]
    lines += [f"| {name}, @60 | {metrics['disturbed'][name]:.3f} |" for name in DISTURBED]
    if switches["changes"]:
        lines.append(
            f"| {switches['changes']} changes from one drawing to another, nobody reset, @60 | "
            f"{switches['agreement']:.3f}, {_times(switches['settle'])} |"
        )
    lines += [
        f"| runs with a wrong tile at any time after step 60; {longevity['runs']} runs, {longevity['steps']} "
        f"steps more | {longevity['runs_with_a_lapse']} |",
        f"| steps until all are right and stay so | {_times(metrics['settle']['clock'])} |",
    ]
    if metrics["weights_cut"]:
        lines += ["", f"{metrics['weights_cut']} weights lay outside the integer range and were cut to it."]
    return "\n".join(lines) + "\n"


def _times(settle: dict[str, float | None]) -> str:
    def text(value: float | None) -> str:
        return "never" if value is None else f"{value:.0f}"

    return f"median {text(settle['median'])}, 95 % within {text(settle['p95'])}"
