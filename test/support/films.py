"""Films of the shipped digits."""

from tilenca.base import paths
from tilenca.model.file import load_model
from tilenca.shapes.batch import load_drawings
from tilenca.simulator.trace import Film, record


def film_of(name: str, steps: int = 12, seed: int = 1) -> Film:
    model = load_model(paths.DEFAULT_MODEL)
    drawings = load_drawings([paths.DEFAULT_SHAPES], labels=model.labels)
    number = [shape.name for shape in drawings.shapes].index(name)
    return record(model, drawings, number, steps, "clock", seed)
