"""Small sweeps."""

from pathlib import Path

from tilenca.base import paths
from tilenca.sweep.axes import FAST, parse_axis
from tilenca.sweep.plan import Plan, Wish, make_plan


def wish(*axes: str, runs: int = 4, engine: str = FAST, **more: object) -> Wish:
    """What a user may ask for: the shipped digits along these axes, in a few runs of 20 steps."""
    usual = {"model": "digits", "files": (paths.DEFAULT_SHAPES,), "steps": 20, "seed": 1}
    return Wish(tuple(map(parse_axis, axes)), engine=engine, runs=runs, **(usual | more))  # type: ignore[arg-type]


def plan(*axes: str, **more: object) -> Plan:
    """The plan of `wish`."""
    return make_plan(wish(*axes, **more))  # type: ignore[arg-type]


ONE = '[[shape]]\nlabel = "1"\ngrid = """\n#\n#\n#\n"""\n'


def one_shape(folder: Path) -> Path:
    """A file with one small drawing."""
    path = folder / "one.toml"
    path.write_text(ONE)
    return path
