"""Films of the shipped digits."""

from tilenca.base import paths
from tilenca.model.file import load_model
from tilenca.shapes.batch import Drawings, load_drawings
from tilenca.simulator.trace import Film, record, record_change


def film_of(name: str, steps: int = 12, seed: int = 1) -> Film:
    return record(load_model(paths.DEFAULT_MODEL), _digits(), _number(name), steps, "clock", seed)


def change_of(old: str, new: str, steps: int, between: int = 0) -> Film:
    model = load_model(paths.DEFAULT_MODEL)
    return record_change(model, _digits(), (_number(old), _number(new)), steps, between, seed=1)


def _digits() -> Drawings:
    return load_drawings([paths.DEFAULT_SHAPES], labels=load_model(paths.DEFAULT_MODEL).labels)


def _number(name: str) -> int:
    return [shape.name for shape in _digits().shapes].index(name)
