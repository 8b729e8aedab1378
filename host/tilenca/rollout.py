"""Cells living through a schedule, and the gradient of where they end up.

`live` computes only the cells that update, into buffers laid out so that each layer's weight gradient is one
matrix product over all rounds. `live_by_autograd` is the same in a dozen plain lines; a test compares them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import torch
from torch import Tensor

from tilenca.model import TileNet, perceive
from tilenca.modelfile import TAPS
from tilenca.schedule import Schedule


@dataclass(frozen=True)
class Events:
    """A schedule as the list of its E updates, on a device.

    Attributes:
        counts: for each of T rounds its number of updates.
        cells: (E,) int64, which cell updates.
        reads: (5 * E,) int64, the rows it perceives, of a table of messages: own 0..N-1, as neighbours have
            heard them N..2N-1, nobody's 2N.
        arrives: (T, N, 1) float32, 1 where the neighbours hear the cell's message at the end of the round.
    """

    counts: list[int]
    cells: Tensor
    reads: Tensor
    arrives: Tensor

    def by_round(self, *arrays: Tensor) -> Iterator[tuple[Tensor, ...]]:
        """For every round its `cells`, `reads`, rows of each of the (E, ...) arrays, and `arrives`."""
        rows = (torch.split(array, self.counts) for array in (self.cells, *arrays))
        reads = torch.split(self.reads, [TAPS * count for count in self.counts])
        return (
            (cells, seen, *others, arrives)
            for (cells, *others), seen, arrives in zip(
                zip(*rows, strict=True), reads, self.arrives.unbind(), strict=True
            )
        )


def list_events(schedule: Schedule, device: torch.device) -> Events:
    """Lists the updates of a schedule in their order."""
    cells = schedule.fires.shape[1]
    when, who = np.nonzero(schedule.fires)
    reads = np.column_stack((who, schedule.neighbours[when, who] + cells))
    return Events(
        schedule.fires.sum(axis=1).tolist(),
        torch.from_numpy(who).to(device),
        torch.from_numpy(reads.reshape(-1)).to(device),
        torch.from_numpy(schedule.arrives[:, :, None].astype(np.float32)).to(device),
    )


def live(net: TileNet, state: Tensor, schedule: Schedule) -> Tensor:
    """Lets cells live through a schedule.

    Args:
        net: the network.
        state: (N, C) float32 in the net's units; no gradient reaches it.
        schedule: T rounds of N cells.

    Returns:
        (N, C) float32, the states after the last round; differentiable by the network's weights.
    """
    events, limit = list_events(schedule, state.device), net.limit if net.bounded else None
    return cast(Tensor, _Life.apply(limit, events, state, *net.weights()))  # type: ignore[no-untyped-call]


class _Life(torch.autograd.Function):
    """Forward keeps what every update saw and did; backward walks the updates from the last to the first."""

    @staticmethod
    def forward(ctx: Any, limit: float | None, events: Events, start: Tensor, *weights: Tensor) -> Tensor:
        w1, b1, w2, b2, w3, b3 = weights
        w1, w2, w3 = w1.t(), w2.t(), w3.t()
        (cells, channels), updates = start.shape, len(events.cells)
        rounded, limit = limit is not None, torch.inf if limit is None else limit
        if rounded:  # floor(x + 1/2) of an activation, the half added with the bias
            b1, b2 = b1 + 0.5, b2 + 0.5
        seen = start.new_empty(updates, TAPS * channels)
        hidden1 = start.new_empty(updates, len(b1))
        hidden2 = start.new_empty(updates, len(b2))
        after = start.new_empty(updates, channels)

        state = start.clone()
        table = start.new_zeros(2 * cells + 1, channels)
        own, sent = table[:cells], table[cells:-1]
        own.copy_(_message(state, rounded))
        sent.copy_(own)
        for who, reads, x, h1, h2, new, arrives in events.by_round(seen, hidden1, hidden2, after):
            torch.index_select(table, 0, reads, out=x.view(-1, channels))
            for inputs, bias, weight, output in ((x, b1, w1, h1), (h1, b2, w2, h2)):
                torch.addmm(bias, inputs, weight, out=output)
                (output.floor_() if rounded else output).clamp_(0.0, limit)
            torch.addmm(b3, h2, w3, out=new)
            new.add_(state.index_select(0, who)).clamp_(-limit, limit)
            state.index_copy_(0, who, new)
            own.index_copy_(0, who, _message(new, rounded))
            torch.lerp(sent, own, arrives, out=sent)

        ctx.limit, ctx.events = limit, events
        ctx.save_for_backward(seen, hidden1, hidden2, after, *weights)
        return state

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        seen, hidden1, hidden2, after, w1, _, w2, _, w3, _ = ctx.saved_tensors
        limit, (cells, channels) = ctx.limit, gradients[0].shape
        d_sum1, d_sum2, d_sum3 = torch.empty_like(hidden1), torch.empty_like(hidden2), torch.empty_like(after)
        d_state = gradients[0].clone()
        d_table = seen.new_zeros(2 * cells + 1, channels)
        d_own, d_sent = d_table[:cells], d_table[cells:-1]
        rounds = list(ctx.events.by_round(hidden1, hidden2, after, d_sum1, d_sum2, d_sum3))
        for who, reads, h1, h2, new, d1, d2, d3, arrives in reversed(rounds):
            # What the neighbours heard at the end of the round was the cell's own message of then.
            heard = d_sent * arrives
            d_own.add_(heard)
            d_sent.sub_(heard)
            d_new = d_state.index_select(0, who).add_(d_own.index_select(0, who))
            d_own.index_fill_(0, who, 0.0)
            _through_clamp(d_new, new, -limit, limit, out=d3)
            d_state.index_copy_(0, who, d3)
            _through_clamp(d3 @ w3, h2, 0.0, limit, out=d2)
            _through_clamp(d2 @ w2, h1, 0.0, limit, out=d1)
            d_table.index_add_(0, reads, (d1 @ w1).view(-1, channels))

        return (
            None, None, None,
            d_sum1.t() @ seen, d_sum1.sum(0),
            d_sum2.t() @ hidden1, d_sum2.sum(0),
            d_sum3.t() @ hidden2, d_sum3.sum(0),
        )  # fmt: skip


def _message(state: Tensor, rounded: bool) -> Tensor:
    return torch.floor(state + 0.5) if rounded else state


def _through_clamp(gradient: Tensor, clamped: Tensor, low: float, high: float, out: Tensor) -> None:
    """Lets the gradient pass where the clamp did not cut."""
    torch.ops.aten.hardtanh_backward.grad_input(gradient, clamped, low, high, grad_input=out)


def live_by_autograd(net: TileNet, state: Tensor, schedule: Schedule) -> Tensor:
    """The same as `live`, computing every cell in every round and leaving the gradient to PyTorch."""
    fires = torch.from_numpy(schedule.fires).to(state.device, state.dtype)[:, :, None]
    arrives = torch.from_numpy(schedule.arrives).to(state.device)[:, :, None]
    neighbours = torch.from_numpy(schedule.neighbours.reshape(len(fires), -1)).to(state.device)
    weights = net.weights()
    own = sent = net.message(state)
    for now in range(len(fires)):
        state = net.update(state, perceive(own, sent, neighbours[now]), fires[now], weights)
        own = net.message(state)
        sent = torch.where(arrives[now], own, sent)
    return state
