"""The network: what a cell perceives, how it updates, and that fast and clear code agree."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from support.integer_network import perceive_by_convolution
from tilenca.base import paths
from tilenca.base.errors import BuildError, UsageError
from tilenca.model.file import LARGEST, SCALES, Dimensions
from tilenca.shapes.batch import Batch, Drawings, load_drawings
from tilenca.training.network import TileNet, initial_arrays, perceive
from tilenca.training.recipes import RECIPES
from tilenca.training.rollout import rollout, rollout_by_autograd, use_threads
from tilenca.training.rollout_kernel import library
from tilenca.training.update_schedule import Circumstances, draw_schedule

FILES = [paths.SHAPES / name for name in ("digits.toml", "digits-3x3.toml", "digits-7x6.toml")]


@pytest.fixture(scope="module")
def drawings() -> Drawings:
    return load_drawings(FILES, 20)


def usual(batch: Batch, **given: NDArray[np.bool_]) -> Circumstances:
    """All tiles on, running and known, but for what is given."""
    per_sample, per_cell = (np.zeros(len(what), np.bool_) for what in (batch.starts, batch.sample))
    nothing = {"staggered": per_sample, "away": per_cell, "lossless": per_sample, "fresh": per_cell}
    return Circumstances(**(nothing | given))


def test_perceiving_real_cells_equals_a_convolution_over_the_whole_grid(drawings: Drawings) -> None:
    random = np.random.default_rng(1)
    for number, shape in enumerate(drawings.shapes):
        batch = drawings.batch(np.array([number]))
        state = torch.from_numpy(random.normal(size=(len(shape.cells), 21)).astype(np.float32))
        grid = torch.zeros(1, 21, len(shape.rows), len(shape.rows[0]))
        rows, columns = map(list, zip(*shape.cells, strict=True))
        grid[0, :, rows, columns] = state.T
        convolved = perceive_by_convolution(grid)[0, :, rows, columns].T
        perceived = perceive(state, state, torch.from_numpy(batch.neighbours.reshape(-1)))
        assert torch.equal(perceived, convolved), f"shape {shape.name}"


def test_own_message_is_perceived_as_it_is_and_neighbours_as_last_sent() -> None:
    own, sent = torch.full((2, 1), 3.0), torch.tensor([[5.0], [7.0]])
    side_by_side = torch.tensor(
        [2, 1, 2, 2, 2, 2, 2, 0]
    )  # cell 0 has cell 1 in the east, cell 1 cell 0 in the west
    assert perceive(own, sent, side_by_side).tolist() == [[3, 0, 7, 0, 0], [3, 0, 0, 0, 5]]


def test_an_untrained_cell_does_nothing() -> None:
    net = TileNet(Dimensions(), True, initial_arrays(Dimensions(), np.random.default_rng(0)))
    state = torch.randint(-127, 128, (9, 21)).float()
    after = net.update(state, torch.randint(-127, 128, (9, 105)).float(), torch.ones(9, 1), net.weights())
    assert torch.equal(after, state)


@pytest.mark.parametrize("quantisation_aware", [True, False])
def test_a_rollout_and_its_gradient_equal_those_of_plain_autograd(
    drawings: Drawings, quantisation_aware: bool
) -> None:
    random = np.random.default_rng(7)
    net = TileNet(Dimensions(), quantisation_aware, initial_arrays(Dimensions(), random, zero_last=False))
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
    assert set(gradients[0]) == set(Dimensions().shapes())
    for name, gradient in gradients[0].items():
        size = gradients[1][name].abs().max()
        assert size > 0, f"no gradient reaches {name}"
        assert (gradient - gradients[1][name]).abs().max() < 1e-4 * size, name


def test_projection_brings_every_weight_into_the_integer_range() -> None:
    huge = {name: np.full(shape, 1e3, np.float32) for name, shape in Dimensions().shapes().items()}
    net = TileNet(Dimensions(), True, huge)
    net.project()
    for name, value in net.named_parameters():
        assert (value * SCALES[name] == LARGEST[name]).all(), name


def test_tiles_on_clocks_update_once_per_period_and_are_heard_after_their_latency(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], clocks=1.0, lossy=0.0, ticks_per_period=(4.0, 4.0), drift=0.0)
    recipe = replace(recipe, latency=(0.5, 0.5))
    batch = drawings.batch(np.array([0]))
    schedule = draw_schedule(
        recipe,
        batch,
        np.array([41]),
        np.random.default_rng(3),
        usual(batch),
    )
    fired, arrived, _ = schedule.by_cell()
    for cell in range(len(batch.sample)):
        fires, arrives = (np.flatnonzero(what[:, cell]) for what in (fired, arrived))
        assert set(np.diff(fires)) == {4}
        assert {(a - fires[fires <= a].max()) for a in arrives if a >= fires[0]} == {2}


def test_a_tile_is_nobody_until_its_first_message_has_arrived(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=0.0, clocks=1.0, stale=1.0, max_stale=0.9)
    batch = drawings.batch(np.array([8]))
    cells = len(batch.sample)
    fresh = np.arange(cells) % 2 == 0
    schedule = draw_schedule(
        recipe, batch, np.array([60]), np.random.default_rng(3), usual(batch, fresh=fresh)
    )
    fires, arrives, neighbours = schedule.by_cell()
    sent = np.logical_or.accumulate(fires) & arrives
    known = np.logical_or.accumulate(np.vstack((~fresh, sent[:-1])))
    before = 0
    for now, cell in np.argwhere(fires):
        for side, other in enumerate(batch.neighbours[cell]):
            if other < cells:
                assert neighbours[now, cell, side] == (other if known[now, other] else cells)
                before += not known[now, other]
    assert before > 10


def test_lost_messages_read_as_nobody(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=1.0, max_loss=1.0, longest_loss=1)
    batch = drawings.batch(np.arange(len(drawings)))
    lengths = np.full(len(drawings), 50)
    schedule = draw_schedule(
        recipe,
        batch,
        lengths,
        np.random.default_rng(3),
        usual(batch),
    )
    fires, _, neighbours = schedule.by_cell()
    lost = fires[:, :, None] & (neighbours != batch.neighbours)
    assert (neighbours[lost] == len(batch.sample)).all()
    asked = fires[:, :, None] & (batch.neighbours < len(batch.sample))
    assert 0.2 < lost.sum() / asked.sum() < 0.8


def test_a_loss_may_last(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=1.0, max_loss=1.0, fire_rate=(1.0, 1.0), clocks=0.0)
    batch = drawings.batch(np.array([8]))

    def changes(longest: int) -> float:
        """How often a neighbour is heard after it was not, or the other way round."""
        some = replace(recipe, longest_loss=longest)
        random = np.random.default_rng(5)
        schedules = [draw_schedule(some, batch, np.array([60]), random, usual(batch)) for _ in range(30)]
        heard = [schedule.by_cell()[2] < len(batch.sample) for schedule in schedules]
        return float(np.mean([np.diff(one.astype(np.int8), axis=0) != 0 for one in heard]))

    assert changes(12) < 0.5 * changes(1)


def test_nobody_updates_before_being_switched_on_or_after_the_end_of_its_life(drawings: Drawings) -> None:
    recipe = replace(RECIPES["full"], lossy=0.0, fire_rate=(1.0, 1.0), clocks=0.0)
    batch = drawings.batch(np.array([0, 0]))
    schedule = draw_schedule(
        recipe,
        batch,
        np.array([20, 30]),
        np.random.default_rng(3),
        usual(batch, staggered=np.array([True, False])),
    )
    fires, _, neighbours = schedule.by_cell()
    late, prompt = fires[:, batch.sample == 0], fires[:, batch.sample == 1]
    assert not late[20:].any()
    assert prompt[:30].all()
    first = np.argmax(late, axis=0)
    assert len(set(first.tolist())) > 3, "tiles are switched on at different times"
    for cell, begin in enumerate(first):
        for side, other in enumerate(batch.neighbours[cell]):
            if other < len(first) and first[other] > begin:
                asleep = neighbours[begin : first[other], cell, side]
                assert (asleep == len(batch.sample)).all(), "a tile that is off was heard"


def test_every_drawing_laid_on_another_keeps_tiles_at_their_places(drawings: Drawings) -> None:
    random = np.random.default_rng(5)
    one, four = (next(n for n, s in enumerate(drawings.shapes) if s.name == name) for name in "14")
    columns = {
        drawings.shapes[four].cells[i]
        for _ in range(200)
        for i in drawings.overlap(one, four, random)
        if i >= 0
    }
    assert columns  # a "1" may have stood on several columns of the "4"
    stays = drawings.overlap(four, one, random)
    assert len(stays) == 5
    assert (stays >= 0).sum() >= 1
    same = drawings.overlap(four, four, random)
    assert same.tolist() == list(range(len(same)))


def test_a_drawing_with_two_labels_in_two_files_is_refused(tmp_path: Path) -> None:
    first, second = tmp_path / "a.toml", tmp_path / "b.toml"
    first.write_text('[[shape]]\nlabel = "1"\ngrid = """\n##\n"""\n')
    second.write_text('[[shape]]\nlabel = "2"\ngrid = """\n##\n"""\n')
    with pytest.raises(UsageError, match=r"b\.toml: '2' is drawn exactly like '1' of .*a\.toml"):
        load_drawings([first, second])


def test_too_many_classes_over_all_files_are_refused(tmp_path: Path) -> None:
    first, second = tmp_path / "a.toml", tmp_path / "b.toml"
    first.write_text('[[shape]]\nlabel = "1"\ngrid = """\n##\n"""\n')
    second.write_text('[[shape]]\nlabel = "2"\ngrid = """\n###\n"""\n')
    with pytest.raises(UsageError, match="2 classes in all files, but the model's state has room for 1"):
        load_drawings([first, second], max_classes=1)


def test_any_number_of_threads_and_parts_lives_the_same_life(drawings: Drawings) -> None:
    random = np.random.default_rng(11)
    batch = drawings.batch(random.integers(len(drawings), size=9))
    lengths = np.full(9, 10)
    schedule = draw_schedule(
        RECIPES["full"], batch, lengths, random, usual(batch, staggered=random.random(9) < 0.3)
    )
    whole = schedule.by_cell()
    for wanted in (1, 2, 5, 40):
        parts = list(schedule.parts(wanted))
        assert len(parts) == wanted
        for part, (cells, some) in enumerate(parts):
            fires, arrives, neighbours = some.by_cell()
            size = cells.stop - cells.start
            assert np.array_equal(fires, whole[0][:, cells]), part
            assert np.array_equal(arrives, whole[1][:, cells])
            away = np.where(neighbours == size, len(batch.sample), neighbours + cells.start)
            assert np.array_equal(away, whole[2][:, cells])


def test_the_result_does_not_depend_on_the_number_of_threads(drawings: Drawings) -> None:
    random = np.random.default_rng(13)
    net = TileNet(Dimensions(), True, initial_arrays(Dimensions(), random, zero_last=False))
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


def test_a_library_that_is_missing_or_damaged_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(BuildError, match="not built yet; run: make setup-train"):
        library(tmp_path / "nothing.so")
    (tmp_path / "damaged.so").write_bytes(b"not a library")
    with pytest.raises(BuildError, match=r"not usable .*; remove it and run: make setup-train"):
        library(tmp_path / "damaged.so")
