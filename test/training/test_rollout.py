"""A rollout and its gradient, on any number of threads."""

import numpy as np
import pytest
import torch

from support.training import usual
from tilenca.model.file import Dimensions
from tilenca.model.initial import initial_arrays
from tilenca.shapes.batch import Drawings
from tilenca.training.network import TileNet
from tilenca.training.recipes import RECIPES
from tilenca.training.rollout import rollout, rollout_by_autograd, use_threads
from tilenca.training.update_schedule import draw_schedule


@pytest.mark.parametrize("quantisation_aware", [True, False])
def test_a_rollout_and_its_gradient_equal_those_of_plain_autograd(
    drawings: Drawings, quantisation_aware: bool
) -> None:
    random = np.random.default_rng(7)
    net = TileNet(
        Dimensions(21, 40, 40),
        quantisation_aware,
        initial_arrays(Dimensions(21, 40, 40), random, zero_last=False),
    )
    batch = drawings.batch(np.arange(len(drawings)))
    # Stored states are whole multiples of 2^-13, saturated.
    states = np.round(random.normal(size=(len(batch.sample), 21)) * 8192).clip(-16256, 16256) / 8192
    start = torch.from_numpy(states.astype(np.float32)) * net.units
    lengths = random.integers(4, 13, len(drawings))
    schedule = draw_schedule(
        RECIPES["full"],
        batch,
        lengths,
        random,
        usual(
            batch,
            staggered=random.random(len(drawings)) < 0.5,
            away=random.random(len(batch.sample)) < 0.1,
            fresh=random.random(len(batch.sample)) < 0.3,
        ),
    )
    pull = torch.from_numpy(random.normal(size=start.shape).astype(np.float32))
    ends, gradients = [], []
    for way in (rollout, rollout_by_autograd):
        net.zero_grad()
        end = way(net, start, schedule)
        (end * pull).sum().backward()  # type: ignore[no-untyped-call]
        ends.append(end.detach())
        gradients.append(
            {name: value.grad.clone() for name, value in net.named_parameters() if value.grad is not None}
        )
    torch.testing.assert_close(ends[0], ends[1], rtol=0, atol=0 if quantisation_aware else 1e-4)
    assert set(gradients[0]) == set(Dimensions(21, 40, 40).shapes())
    for name, gradient in gradients[0].items():
        size = gradients[1][name].abs().max()
        assert size > 0, f"no gradient reaches {name}"
        assert (gradient - gradients[1][name]).abs().max() < 1e-4 * size, name


def test_the_result_does_not_depend_on_the_number_of_threads(drawings: Drawings) -> None:
    random = np.random.default_rng(13)
    net = TileNet(
        Dimensions(21, 40, 40), True, initial_arrays(Dimensions(21, 40, 40), random, zero_last=False)
    )
    batch = drawings.batch(random.integers(len(drawings), size=16))
    schedule = draw_schedule(RECIPES["full"], batch, np.full(16, 12), random, usual(batch))
    start = torch.zeros(len(batch.sample), 21)
    start[:, 0] = net.units
    gradients = []
    try:
        for threads in (1, 2, 3):
            use_threads(threads)
            net.zero_grad()
            rollout(net, start, schedule).square().sum().backward()  # type: ignore[no-untyped-call]
            gradients.append([value.grad.clone() for value in net.parameters() if value.grad is not None])
    finally:
        use_threads(1)
    for other in gradients[1:]:
        assert all(torch.equal(a, b) for a, b in zip(gradients[0], other, strict=True))
