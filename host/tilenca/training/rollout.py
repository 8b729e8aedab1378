"""Cells living through a schedule, and the gradient of where they end up.

`live_by_autograd` says it in a dozen plain lines, and runs on any device. On a CPU `live` computes the same
in one compiled call (`rollout_kernel`), and only the cells that update; a test compares them.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar, cast

import numpy as np
import torch
from torch import Tensor

from tilenca.training.network import TileNet, perceive
from tilenca.training.rollout_kernel import Life, Tape
from tilenca.training.update_schedule import Schedule

PARTS = 2  # of a batch, of equal size
_threads: ThreadPoolExecutor | None = None
Part = TypeVar("Part")
Result = TypeVar("Result")


def live(net: TileNet, state: Tensor, schedule: Schedule) -> Tensor:
    """Lets cells live through a schedule.

    Args:
        net: the network.
        state: (N, C) float32 in the net's units; no gradient reaches it.
        schedule: T rounds of N cells.

    Returns:
        (N, C) float32, the states after the last round; differentiable by the network's weights.
    """
    if state.device.type != "cpu":
        return live_by_autograd(net, state, schedule)
    limit = net.limit if net.bounded else None
    return cast(Tensor, _Life.apply(limit, schedule, state, *net.weights()))  # type: ignore[no-untyped-call]


class _Life(torch.autograd.Function):
    """Forward keeps what every update saw and did; backward walks the updates from the last to the first.

    A batch is always computed in the same parts, so that the same seed gives the same model with any
    number of threads.
    """

    @staticmethod
    def forward(ctx: Any, limit: float | None, schedule: Schedule, start: Tensor, *weights: Tensor) -> Tensor:
        state = start.clone()

        def live_part(part: tuple[slice, Schedule]) -> tuple[slice, Life, Tape]:
            cells, of = part
            events = (of.counts, of.who, of.reads, np.ascontiguousarray(of.arrives))
            life = Life(weights, limit, len(of.arrives[0]), *map(torch.from_numpy, events))
            return cells, life, life.forward(state[cells])

        ctx.parts = _side_by_side(live_part, schedule.parts(PARTS))
        return state

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        def gradients_of(part: tuple[slice, Life, Tape]) -> tuple[Tensor, ...]:
            cells, life, tape = part
            _, d1, d2, d3 = life.backward(gradients[0][cells].clone(), tape)
            return (
                d1.t() @ tape.seen, d1.sum(0),
                d2.t() @ tape.hidden1, d2.sum(0),
                d3.t() @ tape.hidden2, d3.sum(0),
            )  # fmt: skip

        every = _side_by_side(gradients_of, ctx.parts)
        return (None, None, None, *(torch.stack(parts).sum(0) for parts in zip(*every, strict=True)))


def _side_by_side(do: Callable[[Part], Result], parts: Iterable[Part]) -> list[Result]:
    """`do` of every part, in as many threads as `use_threads` said."""
    return [do(part) for part in parts] if _threads is None else list(_threads.map(do, parts))


def use_threads(count: int) -> None:
    """How many processors training may use; the result does not depend on it."""
    global _threads
    if _threads is not None:
        _threads.shutdown()
    torch.set_num_threads(1)  # products this small gain nothing from PyTorch's own threads
    _threads = (
        None if count == 1 else ThreadPoolExecutor(count, initializer=torch.set_num_threads, initargs=(1,))
    )


def live_by_autograd(net: TileNet, state: Tensor, schedule: Schedule) -> Tensor:
    """The same as `live`, computing every cell in every round and leaving the gradient to PyTorch."""
    fires, arrives, neighbours = (torch.from_numpy(a).to(state.device) for a in schedule.by_cell())
    weights = net.weights()
    own = sent = net.message(state)
    for now in range(len(fires)):
        perceived = perceive(own, sent, neighbours[now].view(-1))
        state = net.update(state, perceived, fires[now, :, None].to(state.dtype), weights)
        own = net.message(state)
        sent = torch.where(arrives[now, :, None], own, sent)
    return state
