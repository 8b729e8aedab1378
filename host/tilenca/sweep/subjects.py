"""The drawings that a sweep asks for: kinds of drawings, and sizes."""

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from pathlib import Path

from tilenca.base.errors import UsageError
from tilenca.evaluation.suites import Aims, recorded_aims, unknown_cases, varied_case
from tilenca.model.file import Model
from tilenca.shapes.batch import Drawings, load_drawings, load_training_task
from tilenca.shapes.derive import at_size, damaged, known_of
from tilenca.shapes.file import UNKNOWN, Shape
from tilenca.shapes.sizes import parse_size
from tilenca.shapes.variant import LAST
from tilenca.sweep.axes import AS_DRAWN
from tilenca.sweep.rows import Subject


class Subjects:
    """The drawings of the shape files, for one model.

    Args:
        model: its labels are the classes.
        files: the shape files.
        seed: of drawings that are made by chance.
        only: names of drawings, or labels; others are left out; empty: all.

    Raises:
        UsageError: a file is not valid, or the model does not know a label.
    """

    def __init__(self, model: Model, files: Sequence[Path], seed: int, only: Sequence[str] = ()) -> None:
        self._model, self._files, self._seed, self._only = model, files, seed, only
        self._drawings = load_drawings(files, labels=model.labels)
        self._known: dict[tuple[str, str], list[Subject]] = {}

    @property
    def sources(self) -> tuple[dict[str, str], ...]:
        """The files and their digests."""
        return self._drawings.sources

    def at(self, kind: str, size: str) -> list[Subject]:
        """The drawings of a kind, at a size.

        Args:
            kind: one of `tilenca.sweep.axes.KINDS`.
            size: rows and columns, or as drawn.

        Raises:
            UsageError: there are none; the message says why.
        """
        if (kind, size) not in self._known:
            every = self._find(kind, size)
            chosen = [subject for subject in every if not self._only or subject.name in self._only]
            missing = set(self._only) - {subject.name for subject in every}
            if missing or not chosen:
                names = " ".join(dict.fromkeys(subject.name for subject in every))
                what = f"no drawing '{min(missing)}'" if missing else "no drawing"
                raise UsageError(f"--axis drawings={kind} size={size}: {what}; there is: {names or 'none'}")
            self._known[kind, size] = chosen
        return self._known[kind, size]

    def _find(self, kind: str, size: str) -> list[Subject]:
        if kind == "drawn":
            return list(self._drawn(size))
        if kind == "damaged":
            return list(self._damaged(size))
        if size != AS_DRAWN:
            raise UsageError(f"--axis drawings={kind}: these have sizes of their own; leave --axis size out")
        return list(self._varied() if kind == "varied" else self._none())

    def _drawn(self, size: str) -> Iterator[Subject]:
        """Each drawing of the files that can be drawn at the size."""
        drawings = self._drawings
        for shape, group in zip(drawings.shapes, drawings.groups, strict=True):
            at = shape if size == AS_DRAWN else shape.stretched(parse_size(size))
            if at is not None:
                yield Subject(shape.name, drawings.sources[group]["file"], (at,))

    def _damaged(self, size: str) -> Iterator[Subject]:
        """Drawings of the first file with one tile missing, of forms that training does not see."""
        first = self._drawings.group(0)
        shapes = first if size == AS_DRAWN else at_size(first, parse_size(size))
        known = known_of([*self._drawings.shapes, *shapes])
        yield from self._by_label(damaged(shapes, known, " less one", LAST))

    def _varied(self) -> Iterator[Subject]:
        """What the classes may become, of forms that training does not see."""
        if (case := varied_case(self._task, self._aims, self._seed, LAST)) is not None:
            yield from self._by_label(case.drawings.shapes)

    def _none(self) -> Iterator[Subject]:
        """Drawings of no class, on which a dash is right."""
        if UNKNOWN not in self._model.labels:
            raise UsageError(f"--axis drawings=unknown: model {self._model.model_id:04X} has no dash to show")
        task = self._task
        cases = unknown_cases(task, task.group(0), self._aims, self._seed, LAST)
        yield from self._by_label([shape for case in cases for shape in case.drawings.shapes])

    @cached_property
    def _aims(self) -> Aims:
        return recorded_aims(self._model)

    @cached_property
    def _task(self) -> Drawings:
        labels = self._model.labels
        most = self._model.dimensions.max_classes
        task, _ = load_training_task(self._files, self._aims.stretch, most, labels)
        return task

    def _by_label(self, shapes: Iterable[Shape]) -> Iterator[Subject]:
        found: dict[str, list[Shape]] = {}
        for shape in shapes:
            found.setdefault(shape.label, []).append(shape)
        for label, mine in found.items():
            yield Subject(label, self._drawings.sources[0]["file"], tuple(mine))
