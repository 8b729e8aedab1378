"""Checks that PyTorch and the wanted device are there."""

from tilenca.base.errors import UsageError
from tilenca.base.project import install_remedy


def check_device(device: str) -> None:
    """Checks the device before long work begins.

    Args:
        device: `cpu` or `cuda`.

    Raises:
        UsageError: PyTorch is not installed, or has no such device; the message says what to do.
    """
    try:
        import torch
    except ImportError as error:
        raise UsageError(
            f"training needs PyTorch, which is not installed; run: {install_remedy('train')}"
        ) from error
    if device not in ("cpu", "cuda"):
        raise UsageError(f"--device {device}: use cpu or cuda")
    if device == "cuda" and not torch.cuda.is_available():
        raise UsageError("--device cuda: PyTorch finds no CUDA device here; use --device cpu")
