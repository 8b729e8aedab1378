"""Adam (Kingma, Ba: https://arxiv.org/abs/1412.6980), to the bit that of `torch.optim` on a CPU.

torch's own imports the compiler of `torch.compile` when it is made. Nothing here is compiled by that, and the
import takes as long as all others of a training together, in the process of every seed.
"""

from collections.abc import Iterable
from typing import Any

import torch
from torch import Tensor

BETAS = 0.9, 0.999  # decay of the mean of the gradient, and of its square
EPSILON = 1e-8
FIRST, SECOND = "exp_avg", "exp_avg_sq"  # names of the means in a checkpoint, as torch's


class Adam:
    """Changes parameters along the mean of their gradients.

    Args:
        parameters: float32 tensors with gradients when `step` is called; they are changed in place.
        rate: the learning rate of `step`; it may be set between steps.
    """

    def __init__(self, parameters: Iterable[Tensor], rate: float) -> None:
        self.parameters = list(parameters)
        self.rate = rate
        self.steps = 0
        self.means = [
            {FIRST: torch.zeros_like(value), SECOND: torch.zeros_like(value)} for value in self.parameters
        ]

    def zero_grad(self) -> None:
        """Forgets all gradients."""
        for value in self.parameters:
            value.grad = None

    @torch.no_grad()
    def step(self) -> None:
        """Changes every parameter by its gradient."""
        self.steps += 1
        first_rate, second_rate = BETAS
        size = self.rate / (1 - first_rate**self.steps)
        correction = (1 - second_rate**self.steps) ** 0.5
        for value, means in zip(self.parameters, self.means, strict=True):
            assert value.grad is not None, "a parameter has no part in the loss"
            means[FIRST].lerp_(value.grad, 1 - first_rate)
            means[SECOND].mul_(second_rate).addcmul_(value.grad, value.grad, value=1 - second_rate)
            spread = (means[SECOND].sqrt() / correction).add_(EPSILON)
            value.addcdiv_(means[FIRST], spread, value=-size)

    def state(self) -> dict[str, Any]:
        """What a checkpoint needs: the number of steps and the means, laid out as by torch's optimiser."""
        steps = torch.tensor(float(self.steps))
        return {"state": {number: {"step": steps, **means} for number, means in enumerate(self.means)}}

    def restore(self, state: dict[str, Any]) -> None:
        """Continues from what `state` returned."""
        for number, means in enumerate(self.means):
            self.steps = int(state["state"][number]["step"])
            for name, mean in means.items():
                mean.copy_(state["state"][number][name])
