"""Prints the speed of training relative to plain PyTorch: bench.training.

All run the same batch through the same ticks and give the gradient of the same loss, on one thread; a check
compares their results. The batch is the paper's: 128 drawings of 5 x 4, half of the tiles in a tick.
"""

import sys
import time
from collections.abc import Callable

import numpy as np
import torch
import torch.nn.functional as F  # noqa: N812 - the usual name
from torch import Tensor

from bench.figures import note, of_rounds
from tilenca.base import paths
from tilenca.model.file import Dimensions
from tilenca.model.initial import initial_arrays
from tilenca.shapes.batch import load_drawings
from tilenca.training.network import TileNet
from tilenca.training.recipes import RECIPES
from tilenca.training.rollout import rollout, rollout_by_autograd, use_threads
from tilenca.training.rollout_kernel import library
from tilenca.training.update_schedule import Circumstances, UpdateSchedule, draw_schedule

TICKS, BATCH, TURNS, SEED = 19, 128, 5, 1


def by_convolution(net: TileNet, start: Tensor, fires: Tensor, tiles: Tensor) -> Tensor:
    """The paper's network as three convolutions, corners of the first kernel zero.

    Args:
        net: the network, in plain real numbers.
        start: (B, C, H, W) float32, zero where there is no tile.
        fires: (T, B, 1, H, W) float32, 1 for a tile that updates.
        tiles: (B, 1, H, W) float32, 1 where there is a tile.

    Returns:
        (B, C, H, W) float32, the states after the last tick.
    """
    w1, b1, w2, b2, w3, b3 = net.weights()
    kernel = w1.new_zeros(len(w1), start.shape[1], 3, 3)
    for part, (row, col) in enumerate(((1, 1), (0, 1), (1, 2), (2, 1), (1, 0))):
        kernel[:, :, row, col] = w1[:, part * start.shape[1] : (part + 1) * start.shape[1]]
    state = start
    for now in fires:
        hidden = F.relu(F.conv2d(state, kernel, b1, padding=1))
        hidden = F.relu(F.conv2d(hidden, w2[:, :, None, None], b2))
        state = (state + now * F.conv2d(hidden, w3[:, :, None, None], b3)) * tiles
    return state


def seconds_of(do: Callable[[], Tensor], net: TileNet) -> float:
    """Processor seconds of a rollout and its gradient."""
    started_s = time.process_time()
    net.zero_grad()
    do().square().sum().backward()  # type: ignore[no-untyped-call]
    return time.process_time() - started_s


def ratio(name: str, slow: Callable[[], Tensor], fast: Callable[[], Tensor], net: TileNet) -> float:
    """The time of the first as a multiple of the second's; the two take turns."""
    turns = [seconds_of(slow, net) / seconds_of(fast, net) for _ in range(TURNS)]
    found = of_rounds(f"training: against {name}", turns, "times as fast")
    note(found)
    return found.value


def main() -> int:
    """Prints the ratios; 1 when ours and the convolutions disagree."""
    use_threads(1)
    random = np.random.default_rng(SEED)
    drawings = load_drawings([paths.DEFAULT_SHAPES])
    batch = drawings.batch(random.integers(len(drawings), size=BATCH))
    cells = len(batch.sample)
    none = np.zeros(BATCH, np.bool_)
    schedule: UpdateSchedule = draw_schedule(
        RECIPES["paper"],
        batch,
        np.full(BATCH, TICKS),
        random,
        Circumstances(none, np.zeros(cells, np.bool_), ~none, np.zeros(cells, np.bool_)),
    )
    net = TileNet(
        Dimensions(21, 40, 40), False, initial_arrays(Dimensions(21, 40, 40), random, zero_last=False)
    )
    with torch.no_grad():  # small steps, or states grow beyond what two orders of summation agree on
        net.get_parameter("w3").mul_(0.1)
    start = torch.zeros(cells, 21)
    start[:, 0] = 1.0

    chosen = np.searchsorted(drawings.classes, batch.target[batch.starts])  # one drawing a class
    places = [cell for number in chosen for cell in drawings.shapes[number].cells]
    rows, cols = (torch.tensor(axis) for axis in zip(*places, strict=True))
    samples = torch.from_numpy(batch.sample)
    size = (max(rows.tolist()) + 1, max(cols.tolist()) + 1)
    tiles, grid = torch.zeros(BATCH, 1, *size), torch.zeros(BATCH, 21, *size)
    fires = torch.zeros(TICKS, BATCH, 1, *size)
    tiles[samples, 0, rows, cols] = 1.0
    grid[samples, :, rows, cols] = start
    fires[:, samples, 0, rows, cols] = torch.from_numpy(schedule.by_cell()[0].astype(np.float32))

    def ours() -> Tensor:
        return rollout(net, start, schedule)

    def convolved() -> Tensor:
        return by_convolution(net, grid, fires, tiles)

    def by_pytorch() -> Tensor:
        return rollout_by_autograd(net, start, schedule)

    apart = (convolved()[samples, :, rows, cols] - ours()).abs().max().item()
    kind = library().ffi.string(library().lib.tilenca_rollout_kind()).decode()
    print(f"training: a rollout of {BATCH} drawings and its gradient, one thread, {kind}")
    ways = {"convolutions over the padded grid": convolved, "plain PyTorch on real tiles": by_pytorch}
    for name, way in ways.items():
        print(f"  {ratio(name, way, ours, net):.1f} times faster than {name}")
    net.update = torch.compile(net.update)  # type: ignore[method-assign]
    by_pytorch().sum().backward()  # type: ignore[no-untyped-call]
    compiled = ratio("torch.compile", by_pytorch, ours, net)
    print(f"  {compiled:.1f} times faster than the latter with torch.compile")
    return int(apart > 1e-4)


if __name__ == "__main__":
    sys.exit(main())
