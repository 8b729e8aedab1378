"""The optimiser is torch's, to the bit, and does not bring torch's compiler along."""

import subprocess
import sys
from pathlib import Path

import pytest
import torch

from tilenca.training.adam import Adam
from tilenca.training.checkpoint import read_checkpoint, write_checkpoint

STEPS = 300
SHAPES = [(12, 105), (12,), (1,)]


def parameters() -> list[torch.nn.Parameter]:
    random = torch.Generator().manual_seed(3)
    return [torch.nn.Parameter(torch.randn(shape, generator=random)) for shape in SHAPES]


def set_gradients(values: list[torch.nn.Parameter], step: int) -> None:
    """As large as they come at the beginning, and as small as at the end; some are zero."""
    random = torch.Generator().manual_seed(step)
    for value in values:
        drawn = torch.randn(value.shape, generator=random) * 10.0 ** -(step % 9)
        value.grad = drawn * (torch.rand(value.shape, generator=random) > 0.1)


def rate(step: int) -> float:
    return 2e-3 * (1 - step / STEPS) + 1e-5


def equal(ours: list[torch.nn.Parameter], theirs: list[torch.nn.Parameter]) -> bool:
    return all(torch.equal(one, other) for one, other in zip(ours, theirs, strict=True))


def test_every_step_is_that_of_torch_to_the_bit() -> None:
    ours, theirs = parameters(), parameters()
    adam, reference = Adam(ours, rate(0)), torch.optim.Adam(theirs, lr=rate(0))
    for step in range(STEPS):
        adam.rate = reference.param_groups[0]["lr"] = rate(step)
        for values in (ours, theirs):
            set_gradients(values, step)
        adam.step()
        reference.step()
        assert equal(ours, theirs), f"step {step}"
    assert not equal(ours, parameters())


@pytest.mark.parametrize("by", ["us", "torch"])
def test_a_run_goes_on_from_a_checkpoint_as_if_it_had_not_ended(by: str, tmp_path: Path) -> None:
    whole, first, second = parameters(), parameters(), parameters()
    uninterrupted = Adam(whole, 1e-3)
    before = Adam(first, 1e-3) if by == "us" else torch.optim.Adam(first, lr=1e-3)
    for step in range(20):
        for values, adam in ((whole, uninterrupted), (first, before)):
            set_gradients(values, step)
            adam.step()
    state = before.state() if isinstance(before, Adam) else before.state_dict()
    write_checkpoint(tmp_path / "checkpoint.pt", {}, {"optimizer": state})
    after = Adam(second, 1e-3)
    with torch.no_grad():
        for value, kept in zip(second, first, strict=True):
            value.copy_(kept)
    after.restore(read_checkpoint(tmp_path / "checkpoint.pt", {}, torch.device("cpu"))["optimizer"])
    for step in range(20, 40):
        for values, adam in ((whole, uninterrupted), (second, after)):
            set_gradients(values, step)
            adam.step()
    assert equal(second, whole)


def test_gradients_are_forgotten() -> None:
    values = parameters()
    set_gradients(values, 0)
    Adam(values, 1e-3).zero_grad()
    assert [value.grad for value in values] == [None] * len(values)


def test_a_parameter_without_a_gradient_is_a_defect() -> None:
    with pytest.raises(AssertionError, match="no part in the loss"):
        Adam(parameters(), 1e-3).step()


def test_a_training_does_not_import_torchs_compiler(two_shapes: Path, tmp_path: Path) -> None:
    program = (
        "import sys\nfrom tilenca import cli\n"
        f"words = ['train', '--shapes', {str(two_shapes)!r}, '--out', {str(tmp_path / 'out')!r}]\n"
        "words += ['--recipe', 'smoke', '--iterations', '2', '--hidden', '8', '--validation-runs', '1']\n"
        "assert cli.main(words) == 0\n"
        "assert 'torch' in sys.modules\n"
        "sys.exit('torch._dynamo' in sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
