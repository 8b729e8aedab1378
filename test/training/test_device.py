"""Before long work it is known whether the device is there."""

import sys

import pytest
import torch

from tilenca.base.errors import UsageError
from tilenca.training.device import check_device


def test_a_processor_is_always_there() -> None:
    check_device("cpu")


def test_a_device_of_another_kind_is_refused() -> None:
    with pytest.raises(UsageError, match="--device tpu: use cpu or cuda"):
        check_device("tpu")


@pytest.mark.skipif(torch.cuda.is_available(), reason="there is a CUDA device here")
def test_a_graphics_card_that_is_not_there_is_refused() -> None:
    with pytest.raises(UsageError, match="no CUDA device here; use --device cpu"):
        check_device("cuda")


def test_without_pytorch_the_set_up_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(UsageError, match="not installed; run: make setup-train"):
        check_device("cpu")
