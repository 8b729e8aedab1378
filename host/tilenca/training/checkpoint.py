"""Checkpoints: a training run in a file, which is written whole or not at all."""

import io
from pathlib import Path
from typing import Any

import torch

from tilenca.base.errors import UsageError
from tilenca.base.whole_file import write_whole

State = dict[str, Any]


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
        } if all(isinstance(label, str) for label in labels) and _are_numbers(history, checks):
            return {"config": config, "iteration": iteration, "history": history, "checks": checks}
    raise UsageError(f"{path}: damaged checkpoint (of another form); train with --force to start anew")


def _are_numbers(history: list[Any], checks: list[Any]) -> bool:
    """Whether rows are (iteration, loss, agreement), and those of measurements begin with two numbers."""
    rows = [tuple(row) if isinstance(row, list | tuple) else () for row in history]
    rows += [(*row[:2], 0) if isinstance(row, list | tuple) else () for row in checks]
    return all(len(row) == 3 and all(isinstance(value, int | float) for value in row) for row in rows)


def read_checkpoint(path: Path, config: State, device: torch.device) -> State:
    """The state that was written, its tensors on `device`.

    Raises:
        UsageError: there is none, it is damaged, or of another configuration.
    """
    state = _load(path, device)
    theirs: State = state["config"]
    for key, value in config.items():
        if theirs.get(key) != value:
            raise UsageError(
                f"{path}: made with another {key}; give the arguments of the run to resume, or train "
                "into another directory"
            )
    return state


def _load(path: Path, device: torch.device) -> State:
    try:
        state: State = torch.load(path, map_location=device, weights_only=True)
        state["config"], state["iteration"]
    except FileNotFoundError as error:
        raise UsageError(f"{path}: nothing to resume; train without --resume") from error
    except Exception as error:  # any exception of torch's unpickler
        raise UsageError(
            f"{path}: damaged checkpoint ({type(error).__name__}); train with --force to start anew"
        ) from error
    return state
