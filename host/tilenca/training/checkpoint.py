"""Checkpoints: a training run in a file, which is written whole or not at all."""

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.whole_file import write_whole
from tilenca.model.file import Dimensions

State = dict[str, Any]
# Which option decides a value of a configuration.
OPTIONS = {
    ("recipe", "iterations"): "--iterations",
    ("dimensions", "hidden1"): "--hidden",
    ("dimensions", "channels"): "--state",
}


def write_checkpoint(path: Path, config: State, state: State) -> None:
    """Writes a checkpoint; an interrupted write leaves the one before.

    Args:
        path: the file.
        config: plain values; they decide the result.
        state: plain values and tensors.

    Raises:
        TilencaError: the disk is full or not writable.
    """
    buffer = io.BytesIO()
    torch.save({"config": config, **state}, buffer)  # torch's exception hides a full disk
    store_checkpoint(path, buffer.getbuffer())


def store_checkpoint(path: Path, data: bytes | memoryview) -> None:
    """Writes the bytes of a checkpoint, which may come from elsewhere, like `write_checkpoint`."""
    write_whole(path, data, "make room there, or give another --out")


def glance(path: Path) -> State:
    """The plain values of a checkpoint, of any configuration: `config`, `iteration`, `history`, `checks`.

    Raises:
        UsageError: there is none, or it is damaged.
    """
    match _load(path, torch.device("cpu")):
        case {
            "config": {"labels": [*labels], "seed": int(), "recipe": {"iterations": int()}} as config,
            "iteration": int() as iteration,
            "history": [*history],
            "checks": [*checks],
        } if all(isinstance(label, str) for label in labels) and _are_rows(history, checks):
            return {"config": config, "iteration": iteration, "history": history, "checks": checks}
    raise damaged(path, "of another form")


def _are_rows(history: list[Any], checks: list[Any]) -> bool:
    """Whether rows are (iteration, loss, agreement), and of measurements (iteration, shortfall, shares)."""
    rows = [row for row in (*history, *checks) if isinstance(row, list | tuple) and len(row) == 3]
    shares = [row[2] for row in rows[len(history) :] if isinstance(row[2], dict)]
    numbers = [value for row in rows[: len(history)] for value in row]
    numbers += [value for row in rows[len(history) :] for value in row[:2]]
    numbers += [value for share in shares for value in share.values()]
    whole = len(rows) == len(history) + len(checks) and len(shares) == len(checks)
    return whole and all(isinstance(value, int | float) for value in numbers)


def read_checkpoint(path: Path, config: State, device: torch.device) -> State:
    """The state that was written, its tensors on `device`.

    Raises:
        UsageError: there is none, it is damaged, or of another configuration.
    """
    state = _load(path, device)
    refuse_other(path, state["config"], config)
    if not _has_result(state, Dimensions(**config["dimensions"])):
        raise damaged(path, "of another form")
    return state


def refuse_other(path: Path, theirs: State, ours: State) -> None:
    """Refuses a checkpoint of another configuration, and says by which options it differs.

    Args:
        path: of the checkpoint.
        theirs: its configuration.
        ours: that of the run that is to go on from it.

    Raises:
        UsageError: they differ.
    """
    if any(theirs.get(key) != value for key, value in ours.items()):
        differing = list(_differences(theirs, ours)) or ["made with other widths"]
        raise UsageError(
            f"{path}: {'; '.join(differing)}; give the arguments of the run to resume, --force to begin "
            "anew, or another directory"
        )


def _differences(theirs: State, ours: State) -> Iterator[str]:
    """Each difference in words, by the name of its option; of a recipe's own values only that they differ."""
    has = "the checkpoint has"
    for (part, key), option in OPTIONS.items():
        mine, other = (_part(config, part).get(key) for config in (ours, theirs))
        if mine != other:
            yield f"{option} {mine}, {has} {other}"
    mine, other = (
        {key: value for key, value in _part(config, "recipe").items() if ("recipe", key) not in OPTIONS}
        for config in (ours, theirs)
    )
    if mine != other:
        yield "another --recipe"
    for key, option in (("seed", "--seed"), ("initial", "--weights")):
        if ours[key] != (other := theirs.get(key)):
            yield f"{option} {ours[key]}, {has} {other}"
    if ours["labels"] != (other := theirs.get("labels")):
        shown = " ".join(map(str, other)) if isinstance(other, list) else other
        yield f"the labels {' '.join(ours['labels'])}, {has} {shown}"
    elif ours["sources"] != theirs.get("sources"):
        yield "the drawings of --shapes have changed since"


def _part(config: State, name: str) -> State:
    part = config.get(name)
    return part if isinstance(part, dict) else {}


def _has_result(state: State, dimensions: Dimensions) -> bool:
    """Whether the values are there that a finished training is made of."""
    match state:
        case {
            "ended": bool(),
            "done": bool(),
            "history": [*history],
            "checks": [*checks],
            "ema": ema,
            "best": None | (int(), int() | float(), _) as best,
        }:
            weights = (ema,) if best is None else (ema, best[2])
            return _are_rows(history, checks) and all(_are_weights(one, dimensions) for one in weights)
    return False


def _are_weights(weights: Any, dimensions: Dimensions) -> bool:
    shapes = dimensions.shapes()
    return (
        isinstance(weights, dict)
        and weights.keys() == shapes.keys()
        and all(
            isinstance(value, torch.Tensor) and value.dtype == torch.float32 for value in weights.values()
        )
        and all(weights[name].shape == shape for name, shape in shapes.items())
    )


def array_like(tensor: torch.Tensor, dtype: np.dtype[Any], row: tuple[int, ...]) -> NDArray[Any]:
    """A copy of a tensor of a checkpoint: (N,) and then `row`, of `dtype`.

    Raises:
        ValueError: it is of another type or form.
    """
    array: NDArray[Any] = tensor.cpu().numpy().copy()
    if array.dtype != dtype or array.ndim == 0 or array.shape[1:] != row:
        raise ValueError(f"{array.dtype} of {array.shape}, and not {dtype} of (N, {row})")
    return array


def damaged(path: Path, reason: str) -> UsageError:
    """The refusal of a checkpoint that cannot be used; the file stays."""
    return UsageError(
        f"{path}: damaged checkpoint ({reason}); put a copy of it there, or train with --force to start anew"
    )


def _load(path: Path, device: torch.device) -> State:
    try:
        data = path.read_bytes()
    except FileNotFoundError as error:
        raise UsageError(f"{path}: nothing to resume; train without --resume") from error
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; make it a file that can be read") from error
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            if (name := archive.testzip()) is not None:  # torch reads past a wrong checksum
                raise ValueError(f"wrong checksum of {name}")
        state: Any = torch.load(io.BytesIO(data), map_location=device, weights_only=True)
    except torch.cuda.OutOfMemoryError as error:
        raise TilencaError(f"{path}: no room for it on {device}; give another --device") from error
    except Exception as error:  # any exception of torch's unpickler
        raise damaged(path, type(error).__name__) from error
    match state:
        case {"config": {}, "iteration": int()}:
            return {str(key): value for key, value in state.items()}
    raise damaged(path, "of another form")
