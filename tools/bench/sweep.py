"""What a sweep costs beyond its runs, and the table of docs/SWEEPS.md.

python -m bench.sweep [--tasks N] [--write docs/SWEEPS.md]  measures tasks, scheduler, memory and data
python -m bench.sweep --table DIR --write docs/SWEEPS.md    the table and pictures of a finished sweep
"""

import argparse
import pickle
import resource
import shutil
import tempfile
import time
from contextlib import closing
from pathlib import Path
from typing import Any

from bench.publish import publish
from tilenca.base import paths
from tilenca.cluster.client import Cluster, open_cluster
from tilenca.cluster.tasks import run_tasks
from tilenca.simulator.rollout_library import CompiledRollout
from tilenca.sweep.axes import FAST, parse_axis
from tilenca.sweep.journal import FILE, Journal
from tilenca.sweep.measure import measure_blocks
from tilenca.sweep.plan import Plan, Wish, make_plan
from tilenca.sweep.rows import Block
from tilenca.sweep.run import run_sweep
from tilenca.sweep.table import PARQUET, read_parquet, rows_of, write_parquet

IMAGES = paths.ROOT / "docs" / "images"
PICTURES = {
    "curves.svg": "Share of runs with all tiles right against lost messages, a curve for each dead share",
    "heat.svg": "The same as a heat map",
    "times.svg": "Median of the steps until all tiles are right and stay so",
}
OVERHEAD_MARKS = "<!-- overhead: made by `make bench`, do not edit -->", "<!-- /overhead -->"
TABLE_MARKS = "<!-- table: made by `make sweep`, do not edit -->", "<!-- /table -->"
ROUNDS = 3
MEGA = 1e6


def nothing(_: Any, task: int) -> int:
    """The smallest task there is."""
    return task


def sample(runs: int) -> Plan:
    """A sweep of the digits, small and large, with messages lost."""
    axes = tuple(map(parse_axis, ("loss=0,0.2,0.4", "size=drawn,12x10")))
    return make_plan(Wish(axes, "digits", (paths.DEFAULT_SHAPES,), FAST, None, runs, 1))


def workers_cpu_s(cluster: Cluster) -> float:
    """Processor time of all workers so far."""
    return float(sum(cluster.client.run(time.process_time).values()))


def tiny_tasks(count: int) -> list[tuple[str, str]]:
    """Many tasks that do nothing, on two workers; scheduler and client share this process."""
    with open_cluster(None, 2) as cluster:
        run_tasks(cluster, nothing, None, range(100), lambda *_: None)
        memory, cpu, there = peak_mb(), time.process_time(), workers_cpu_s(cluster)
        started = time.monotonic()
        run_tasks(cluster, nothing, None, range(count), lambda *_: None)
        wall_s = time.monotonic() - started
        here_ms = (time.process_time() - cpu) / count * 1e3
        there_ms = (workers_cpu_s(cluster) - there) / count * 1e3
    return [
        (f"{count:,} tasks that do nothing, two workers", f"{wall_s:.0f} s"),
        ("processor time of scheduler and client for a task", f"{here_ms:.2f} ms"),
        ("processor time of a worker for a task", f"{there_ms:.2f} ms"),
        ("memory that the process of scheduler and client needed more", f"{peak_mb() - memory:.0f} MB"),
    ]


def peak_mb() -> float:
    """The most memory that this process had, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def own_speed(plan: Plan, blocks: list[Block]) -> tuple[float, float]:
    """Cell updates a second of the simulator by itself, and of the blocks with all that surrounds it.

    The first counts the calls of the compiled rollout alone, as `tilenca simulate` does.
    """
    inside = 0.0
    run = CompiledRollout.run

    def timed(self: CompiledRollout, *arguments: Any) -> None:
        nonlocal inside
        started = time.thread_time()
        run(self, *arguments)
        inside += time.thread_time() - started

    CompiledRollout.run = timed  # type: ignore[method-assign,assignment]
    try:
        measured = measure_blocks(plan.luggage, blocks)
    finally:
        CompiledRollout.run = run  # type: ignore[method-assign]
    updates = sum(counts.updates for counts in measured.counts.values())
    return updates / inside, updates / measured.cpu_s


def throughput() -> list[tuple[str, str]]:
    """The same blocks: the simulator alone, in tasks, and in workers of a cluster, in turns."""
    plan = sample(100)
    blocks = [block for row in plan.rows for block in row.blocks()]
    alone, tasks, workers = [], [], []
    with open_cluster(None, 1) as cluster:
        for _ in range(ROUNDS):
            own, whole = own_speed(plan, blocks)
            alone.append(own)
            tasks.append(whole)
            with tempfile.TemporaryDirectory() as name, closing(Journal(Path(name), {}, "")) as journal:
                before = workers_cpu_s(cluster)
                progress = run_sweep(plan, journal, cluster, lambda progress: None)
                workers.append(progress.updates / (workers_cpu_s(cluster) - before))
    best = max(alone)
    return [
        ("simulator by itself, one core", f"{best / MEGA:.2f} million cell updates/s"),
        ("the same in blocks of 100 runs, set-up and counting included", f"{max(tasks) / best:.1%} of it"),
        ("the same in a worker, all of its processor time", f"{max(workers) / best:.1%} of it"),
    ]


def data() -> list[tuple[str, str]]:
    """Bytes that travel and that stay."""
    plan = sample(100)
    blocks = [block for row in plan.rows for block in row.blocks()][:20]
    measured = measure_blocks(plan.luggage, blocks)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with closing(Journal(folder, {}, "")) as journal:
            empty = (folder / FILE).stat().st_size
            journal.add(measured.counts)
        line = (folder / FILE).stat().st_size - empty
        counts = {
            block.key: next(iter(measured.counts.values())) for row in plan.rows for block in row.blocks()
        }
        rows = rows_of(plan, counts, lambda row, whole: f"tilenca sweep {row.key}")
        table = write_parquet(folder, rows, {}).stat().st_size
    each = len(blocks)
    return [
        ("what travels once to each worker (model)", f"{len(pickle.dumps(plan.luggage)) / 1e3:.0f} kB"),
        (
            "what travels to a worker for a block, and back",
            f"{len(pickle.dumps(blocks)) / each:.0f} and {len(pickle.dumps(measured)) / each:.0f} bytes",
        ),
        ("a block in the journal", f"{line / each:.0f} bytes"),
        ("a row of the table in Parquet", f"{table / len(rows):.0f} bytes"),
    ]


def overhead(tasks: int) -> str:
    """The section of the document."""
    rows = [*tiny_tasks(tasks), *throughput(), *data()]
    lines = ["| measured | |", "|---|---|", *(f"| {name} | {value} |" for name, value in rows)]
    return "\n".join(
        [
            *lines,
            "",
            "Processor times suffer little from other programs; the seconds are of two shared cores.",
        ]
    )


def written_table(folder: Path) -> str:
    """The cells of a finished sweep of dead tiles and lost messages, as a table for each size."""
    rows, about = read_parquet(folder / PARQUET)
    cells = [row for row in rows if row["shape"] == "all"]
    lines = [
        f"Model {cells[0]['model_id']}, seed {cells[0]['seed']}, {cells[0]['runs']:,} runs in each cell, by:",
        "",
    ]
    lines += ["```text", about["tilenca.command"], "```"]
    losses = list(dict.fromkeys(row["loss"] for row in cells))
    for size in dict.fromkeys(row["size"] for row in cells):
        mine = [row for row in cells if row["size"] == size]
        lines += [
            "",
            f"Size {size}, after {mine[0]['steps']} steps, {mine[0]['tiles']:.0f} tiles on average:",
            "",
        ]
        lines += [
            f"| dead \\ lost | {' | '.join(f'{loss:.0%}' for loss in losses)} |",
            "|---" * (len(losses) + 1) + "|",
        ]
        for dead in dict.fromkeys(row["dead"] for row in mine):
            shown = [
                f"{row['share']:.3f} ({row['low']:.3f}-{row['high']:.3f})"
                for row in mine
                if row["dead"] == dead
            ]
            lines.append(f"| {dead:.0%} | {' | '.join(shown)} |")
    for name, caption in PICTURES.items():
        lines += ["", f"![{caption}](images/sweep-{name})"]
    return "\n".join(lines)


def main() -> None:
    """Measures and prints, and writes if asked."""
    parser = argparse.ArgumentParser(prog="bench.sweep", description="What a sweep costs beyond its runs.")
    parser.add_argument(
        "--tasks", type=int, default=100_000, metavar="N", help="tasks that do nothing (100,000)"
    )
    parser.add_argument(
        "--table", type=Path, metavar="DIR", help="instead: the table of the finished sweep in DIR"
    )
    parser.add_argument("--write", type=Path, metavar="FILE", help="write it into this document, too")
    args = parser.parse_args()
    if args.table is None:
        publish(overhead(args.tasks), args.write, *OVERHEAD_MARKS)
        return
    publish(written_table(args.table), args.write, *TABLE_MARKS)
    if args.write is not None:
        for name in PICTURES:
            shutil.copy(args.table / name, IMAGES / f"sweep-{name}")


if __name__ == "__main__":
    main()
