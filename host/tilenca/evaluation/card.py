"""The model card: a model's origin, its scores, and the command that makes it again."""

from typing import Any

from tilenca.model import cost
from tilenca.model.file import Model

# Recipes have a library since forms are held out.
SPLIT_BY_FORM = "New pairs and drawings of no class had no form in common with those that did."
CHOSEN = "Held-out sizes helped to choose when to stop, with other runs than these. "
ABOUT_DIRECTIONS = (
    " Tiles of this model also say on which side one is missing. In rows about tiles beside a gap, and about "
    "the others, a run is a tile; the intervals take tiles as independent, and those of a body are not."
)
NOT_SPLIT = (
    "This model was trained before drawings were held out by form: of the new pairs and the drawings of no "
    "class some may have been trained, at this size or another."
)


def render_card(model: Model, metrics: dict[str, Any]) -> str:
    """README.md of a model directory.

    Args:
        model: the model.
        metrics: what `tilenca.evaluation.validation.validate` returned for it.
    """
    size, metadata = model.dimensions, model.metadata
    files = ", ".join(f"`{source['file']}`" for source in metadata["sources"])
    ending = (
        f"ended after {metrics['iterations']} of {metadata['recipe']['iterations']} iterations, since all "
        "targets held"
        if metrics["ended_early"]
        else f"{metadata['recipe']['iterations']} iterations"
    )
    if metrics["best_iteration"] != metrics["iterations"]:
        ending += f"; these are the best measured weights, of iteration {metrics['best_iteration']}"
    lines = [
        f"# Model {model.model_id:04X}: {' '.join(model.labels)}",
        "",
        f"Tells {len(model.labels)} classes apart. State of {size.channels} channels, hidden layers of "
        f"{size.hidden1} and {size.hidden2}, int8 weights, arithmetic of docs/PROTOCOL.md section 4. "
        "`model.json` describes it, `weights.npz` holds real and integer weights, `metrics.json` every "
        "number below, `history.csv` the history of training (`tilenca plot` draws it).",
        "",
        f"It {cost.check(size, len(model.labels))}",
        "",
        "## How it was made",
        "",
        f"Recipe `{metadata['recipe_name']}` ({ending}), seed {metadata['seed']}, trained on {files}, "
        f"at commit {metadata['commit']}.",
        "",
        "To make it again, to the byte at that commit, on the same PyTorch and processor:",
        "",
        f"    {metadata['command']}",
        "",
        "![loss and agreement over the iterations](history.png)",
        "",
        "## What it scores",
        "",
        f"The firmware's own integers, {metrics['runs_per_drawing']} runs of every drawing in the main rows. "
        "A step is one update per tile; a run counts when *every* tile shows the right class after the steps "
        "of the second column. In the others all tiles show the dash, or all the same wrong class, or the "
        "tiles of one body differ (split). Where a row does not say otherwise, tiles run on their own "
        "clocks: each has a fixed phase, a period up to 1 % off and 0.1 to 0.9 periods of latency, sends its "
        "seed when it is switched on, and updates for the first time one period later. All are switched on "
        "within 10 periods; steps count from the last one, or from the last change. Intervals are Wilson's, "
        "for these drawings. A target of 1.000 holds where the share rounds to 1.000. "
        + (CHOSEN if metadata["recipe"]["check_every"] else "")
        + (SPLIT_BY_FORM if "library" in metadata["recipe"] else NOT_SPLIT)
        + (ABOUT_DIRECTIONS if size.directions else "")
        + " To measure it again:",
        "",
        f"    tilenca evaluate --suite --model DIR --shapes {' '.join(metadata['shapes'])} "
        f"--runs {metrics['runs_per_drawing']} --seed {metrics['seed']}",
        "",
        f"{metrics['targets_held']} targets held.",
        "",
        "| what | after steps | drawings | runs | all tiles right | 95 % interval | dash | wrong | split | "
        "worst drawing | converged: median, 95 % | target |",
        f"{'|---' * 12}|",
    ]
    lines += [_row(row) for row in metrics["rows"]]
    if metrics["weights_cut"]:
        lines += ["", f"{metrics['weights_cut']} weights lay outside the integer range and were cut to it."]
    return "\n".join(lines) + "\n"


def _row(row: dict[str, Any]) -> str:
    if row["target"] is not None:
        target = f"{row['target']:.3f} {'held' if row['holds'] else '**missed**'}"
    else:
        target = "" if row.get("best") is None else f"at best {row['best']:.3f}"
    cells = (
        row["name"],
        f"{row['steps']}",
        f"{row['drawings']}",
        f"{row['runs']}",
        f"{row['share']:.4f}",
        f"{row['low']:.4f} to {row['high']:.4f}",
        *(_share(row.get(kind)) for kind in ("dash", "wrong", "split")),
        f"`{row['worst']['shape']}` {row['worst']['share']:.3f}",
        f"{_time(row['convergence']['median'])}, {_time(row['convergence']['p95'])}"
        if row["convergence"]
        else "",
        target,
    )
    return f"| {' | '.join(cells)} |"


def _share(share: float | None) -> str:
    """A share of the runs; nothing where it was not measured."""
    return "" if share is None else f"{share:.4f}"


def _time(steps: float | None) -> str:
    return "never" if steps is None else f"{steps:.0f}"
