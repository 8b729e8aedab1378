"""The rollout's inner loop, compiled; test_rollout.py compares what it computes with plain PyTorch."""

import torch

from tilenca.training.rollout_kernel import library, make_tape


def test_rows_of_a_tape_are_padded_to_what_the_library_adds_up_at_once() -> None:
    block = library().lib.TILENCA_ROLLOUT_PADDING
    tape = make_tape(3, 5 * 21, block, block + 1, 1)
    for rows, width in zip(tape, (105, block, block + 1, 1), strict=True):
        assert rows.shape == (3, width)
        assert rows.dtype == torch.float32
        assert rows.stride(0) % block == 0
        assert 0 <= rows.stride(0) - width < block


def test_a_tape_of_no_updates_has_no_rows() -> None:
    assert [len(rows) for rows in make_tape(0, 105, 12, 12, 21)] == [0, 0, 0, 0]
