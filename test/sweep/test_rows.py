"""Rows, their blocks, and the chance of each block."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tilenca.shapes.file import Shape
from tilenca.sweep.axes import EMULATOR, FAST, parse_axis, points
from tilenca.sweep.rows import BLOCK_UPDATES, Block, Row, Subject, tasks_of

BAR = Shape("1", ("#", "#", "#"), "1")
LONG = Shape("1", ("#",) * 5, "1@2")


def row(*axes: str, runs: int = 10, engine: str = FAST, shapes: tuple[Shape, ...] = (BAR,)) -> Row:
    point = points([parse_axis(axis) for axis in axes], engine)[0]
    return Row(point, engine, "ABCD", 60, Subject("1", "f.toml", shapes), runs)


@given(st.integers(1, 20_000))
def test_blocks_have_every_run_once(runs: int) -> None:
    blocks = list(row(runs=runs).blocks())
    assert [block.number for block in blocks] == list(range(len(blocks)))
    done = [number for block in blocks for number in range(block.first, block.first + block.runs)]
    assert done == list(range(runs))


def test_drawings_take_turns_across_blocks() -> None:
    both = row(runs=5, engine=EMULATOR, shapes=(BAR, LONG))
    assert [block.drawings() for block in both.blocks()] == [[0], [1], [0], [1], [0]]


def test_a_block_of_the_fast_simulator_is_some_work_and_of_the_emulator_one_run() -> None:
    block = next(row(runs=10**6).blocks())
    assert 0.9 * BLOCK_UPDATES <= block.runs * 3 * 70 <= BLOCK_UPDATES
    assert next(row(runs=100, engine=EMULATOR).blocks()).runs == 1


def test_chance_comes_from_the_seed_the_conditions_the_drawing_and_the_block_alone() -> None:
    one = row("loss=0.1")
    base = Block(one, 0, 0, 5).seed(1)
    assert base == Block(row("loss=0.10", "dead=0", runs=99), 0, 0, 5).seed(1)
    others = [
        Block(one, 0, 0, 5).seed(2),
        Block(one, 1, 5, 5).seed(1),
        Block(row("loss=0.2"), 0, 0, 5).seed(1),
        Block(row("loss=0.1", shapes=(LONG,)), 0, 0, 5).seed(1),
        Block(replace(one, model_id="0001"), 0, 0, 5).seed(1),
        Block(replace(one, steps=61), 0, 0, 5).seed(1),
    ]
    assert len({base, *others}) == 1 + len(others)


def test_a_model_by_another_name_is_the_same_model() -> None:
    assert row("model=digits").key == row("model=models/digits").key


@pytest.mark.parametrize("task_s", [0.001, 0.5, 1e6])
def test_tasks_have_every_block_once_in_order(task_s: float) -> None:
    blocks = [block for engine in (FAST, EMULATOR) for block in row(runs=9, engine=engine).blocks()]
    tasks = tasks_of(blocks, task_s)
    assert [block for task in tasks for block in task] == blocks
    assert all(task for task in tasks)


def test_tasks_are_as_long_as_asked() -> None:
    blocks = list(row(runs=400, engine=EMULATOR).blocks())
    tasks = tasks_of(blocks, 10 * blocks[0].cost_s)
    assert {len(task) for task in tasks} == {10}
    assert tasks_of([], 1.0) == []


def test_an_axis_that_came_later_leaves_the_chance_of_rows_that_do_not_vary_it() -> None:
    usual = row("loss=0.1")
    before = {name: value for name, value in usual.point.items() if name != "latency"}
    assert usual.key == replace(usual, point=before).key
    assert row("loss=0.1", "latency=0.1-0.9").key == usual.key
    assert row("loss=0.1", "latency=0.5").key != usual.key
