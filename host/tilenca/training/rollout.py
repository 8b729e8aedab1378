"""Rollouts of cells on a schedule, and the gradient of their last states.

`rollout_by_autograd` does it in a dozen plain lines, on any device. On a CPU `rollout` computes the same in
one compiled call (`rollout_kernel`), and computes only the cells that update; a test compares the two.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar, cast

import numpy as np
import torch
from torch import Tensor

from tilenca.training.network import TileNet, perceive
from tilenca.training.rollout_kernel import KernelRollout, Tape
from tilenca.training.update_schedule import UpdateSchedule

PARTS = 2  # of a batch, of equal size
_threads: ThreadPoolExecutor | None = None
Part = TypeVar("Part")
Result = TypeVar("Result")


def rollout(net: TileNet, state: Tensor, schedule: UpdateSchedule) -> Tensor:
    """Runs cells on a schedule.

    Args:
        net: the network.
        state: (N, C) float32 in the net's units; no gradient reaches it.
        schedule: T ticks of N cells.

    Returns:
        (N, C) float32, the states after the last tick; differentiable by the network's weights.
    """
    if state.device.type != "cpu":
        return rollout_by_autograd(net, state, schedule)
    limit = net.limit if net.quantisation_aware else None
    return cast(Tensor, _Rollout.apply(limit, schedule, state, *net.weights()))  # type: ignore[no-untyped-call]


class _Rollout(torch.autograd.Function):
    """Forward records inputs and results of every update; backward goes from the last update to the first.

    A batch is always computed in the same parts, so that the same seed gives the same model with any
    number of threads.
    """

    @staticmethod
    def forward(
        ctx: Any, limit: float | None, schedule: UpdateSchedule, start: Tensor, *weights: Tensor
    ) -> Tensor:
        state = start.clone()

        def rollout_part(part: tuple[slice, UpdateSchedule]) -> tuple[slice, KernelRollout, Tape]:
            cells, of = part
            events = (of.counts, of.updating, of.reads, np.ascontiguousarray(of.arrives))
            kernel = KernelRollout(weights, limit, len(of.arrives[0]), *map(torch.from_numpy, events))
            return cells, kernel, kernel.forward(state[cells])

        ctx.parts = _side_by_side(rollout_part, schedule.parts(PARTS))
        return state

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        def gradients_of(part: tuple[slice, KernelRollout, Tape]) -> tuple[Tensor, ...]:
            cells, kernel, tape = part
            _, d1, d2, d3 = kernel.backward(gradients[0][cells].clone(), tape)
            return (
                d1.t() @ tape.seen, d1.sum(0),
                d2.t() @ tape.hidden1, d2.sum(0),
                d3.t() @ tape.hidden2, d3.sum(0),
            )  # fmt: skip

        every = _side_by_side(gradients_of, ctx.parts)
        return (None, None, None, *(torch.stack(parts).sum(0) for parts in zip(*every, strict=True)))


def _side_by_side(do: Callable[[Part], Result], parts: Iterable[Part]) -> list[Result]:
    """Calls `do` for every part, in the threads that `use_threads` set."""
    return [do(part) for part in parts] if _threads is None else list(_threads.map(do, parts))


def use_threads(count: int) -> None:
    """Sets how many processors training may use; the result does not depend on it."""
    global _threads
    if _threads is not None:
        _threads.shutdown()
    torch.set_num_threads(1)  # products this small gain nothing from PyTorch's own threads
    _threads = (
        None if count == 1 else ThreadPoolExecutor(count, initializer=torch.set_num_threads, initargs=(1,))
    )


def rollout_by_autograd(net: TileNet, state: Tensor, schedule: UpdateSchedule) -> Tensor:
    """The same as `rollout`, computing every cell in every tick and leaving the gradient to PyTorch."""
    fires, arrives, neighbours = (torch.from_numpy(a).to(state.device) for a in schedule.by_cell())
    weights = net.weights()
    own = sent = net.message(state)
    for now in range(len(fires)):
        perceived = perceive(own, sent, neighbours[now].view(-1))
        state = net.update(state, perceived, fires[now, :, None].to(state.dtype), weights)
        own = net.message(state)
        sent = torch.where(arrives[now, :, None], own, sent)
    return state
