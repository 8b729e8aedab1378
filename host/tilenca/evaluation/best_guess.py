"""The best that tiles could do where dead tiles cut a drawing into pieces that cannot talk to each other.

A piece is a drawing of its own, and other drawings may leave the same piece. Whatever its tiles compute, they
can give only one answer for each piece, so some drawings must go wrong.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np

from tilenca.base.sides import OFFSETS
from tilenca.shapes.cells import beside
from tilenca.shapes.edits import Cell, rows_of
from tilenca.shapes.file import Shape
from tilenca.shapes.stretch import Rows

MOST_TRIES = 200_000  # of answers to a group of pieces; larger groups are improved piece by piece


@dataclass(frozen=True)
class Cut:
    """A drawing without one of its tiles.

    Attributes:
        label: of the drawing.
        pieces: the connected rests.
        weight: its share of all runs.
    """

    label: str
    pieces: frozenset[Rows]
    weight: float


def cuts_of(shapes: Sequence[Shape]) -> list[Cut]:
    """Every drawing without each of its tiles; drawings weigh the same, and so do the tiles of each."""
    return [
        Cut(
            shape.label,
            frozenset(rows_of(piece) for piece in pieces(set(shape.cells) - {gone})),
            1 / (len(shapes) * len(shape.cells)),
        )
        for shape in shapes
        for gone in shape.cells
    ]


def pieces(cells: set[Cell]) -> Iterator[set[Cell]]:
    """The connected parts of a set of cells."""
    left = set(cells)
    while left:
        piece, front = set(), [left.pop()]
        while front:
            row, col = cell = front.pop()
            piece.add(cell)
            near = {(row + down, col + right) for down, right in OFFSETS} & left
            left -= near
            front += near
        yield piece


@lru_cache(maxsize=16)
def best_share(shapes: tuple[Shape, ...]) -> float:
    """The largest share of runs with one dead tile in which all pieces can name their drawing.

    Tiles of a piece that is a whole drawing name that one, since they cannot tell that it is none.

    Args:
        shapes: the drawings, each with the same number of runs, and each tile dead as often as any other.

    Returns:
        The share, 0..1. Where too many answers are possible (`MOST_TRIES`), it is a share that can be
        reached, not always the largest.
    """
    answers = {shape.rows: shape.label for shape in shapes}
    cuts = [cut for cut in cuts_of(shapes) if all(answers.get(p, cut.label) == cut.label for p in cut.pieces)]
    claims: dict[Rows, set[str]] = {}
    for cut in cuts:
        for piece in cut.pieces - answers.keys():
            claims.setdefault(piece, set()).add(cut.label)
    contested = {piece: sorted(labels) for piece, labels in claims.items() if len(labels) > 1}
    total = sum(cut.weight for cut in cuts if not cut.pieces & contested.keys())
    for group in _groups(cuts, contested):
        mine = [cut for cut in cuts if cut.pieces & group.keys()]
        total += max(_right(mine, dict(zip(group, choice, strict=True))) for choice in _choices(mine, group))
    return total


def _right(cuts: Iterable[Cut], answers: Mapping[Rows, str]) -> float:
    """The weight of the cuts all of whose pieces get the right answer."""
    return sum(cut.weight for cut in cuts if all(answers.get(p, cut.label) == cut.label for p in cut.pieces))


def _groups(cuts: Sequence[Cut], contested: Mapping[Rows, list[str]]) -> Iterator[dict[Rows, list[str]]]:
    """Contested pieces that occur together in a cut, directly or through others."""
    left = dict(contested)
    while left:
        group = {next(iter(left))}
        while (
            more := {piece for cut in cuts if cut.pieces & group for piece in cut.pieces & left.keys()}
            - group
        ):
            group |= more
        yield {piece: left.pop(piece) for piece in sorted(group)}


def _choices(cuts: Sequence[Cut], group: Mapping[Rows, list[str]]) -> Iterator[tuple[str, ...]]:
    """All answers to a group of pieces, or where these are too many, better and better ones."""
    count = 1
    for labels in group.values():
        count *= len(labels)
    if count <= MOST_TRIES:
        yield from product(*group.values())
        return
    answers = {piece: labels[0] for piece, labels in group.items()}
    best = -1.0
    while (now := _right(cuts, answers)) > best:
        best = now
        for piece, labels in group.items():
            answers[piece] = max(labels, key=lambda label: _right(cuts, answers | {piece: label}))
        yield tuple(answers.values())


@lru_cache(maxsize=16)
def guessed_share(shapes: tuple[Shape, ...], dead: float, tries: int, seed: int) -> float:
    """The share of runs with dead tiles in which all pieces name their drawing by guessing the likeliest.

    A piece knows itself and that its neighbours are dead or absent, and nothing about other pieces.

    Args:
        shapes: the drawings, each as likely as any other.
        dead: the share of dead tiles, 0..1; each is dead by itself, and at least one lives.
        tries: runs to draw.
        seed: of the dead tiles.
    """
    random = np.random.default_rng(seed)
    guesses: dict[Rows, str] = {}
    right = 0
    for _ in range(tries):
        shape = shapes[int(random.integers(len(shapes)))]
        draws = random.random(len(shape.cells))
        alive = (draws >= dead) | (draws == draws.max())
        living = {cell for cell, lives in zip(shape.cells, alive, strict=True) if lives}
        found = [rows_of(piece) for piece in pieces(living)]
        for piece in found:
            if piece not in guesses:
                guesses[piece] = _likeliest(shapes, piece, dead)
        right += all(guesses[piece] == shape.label for piece in found)
    return right / tries


def _likeliest(shapes: Sequence[Shape], piece: Rows, dead: float) -> str:
    """The label of the drawings that most likely leave a piece: by how many tiles around it must be dead."""
    cells = Shape("", piece, "").cells
    around = beside(cells)
    chances: dict[str, float] = {}
    for shape in shapes:
        tiles = set(shape.cells)
        for down in range(len(shape.rows) - len(piece) + 1):
            for right in range(len(shape.rows[0]) - len(piece[0]) + 1):
                if all((row + down, col + right) in tiles for row, col in cells):
                    gone = sum((row + down, col + right) in tiles for row, col in around)
                    chances[shape.label] = chances.get(shape.label, 0.0) + dead**gone
    return max(chances, key=lambda label: chances[label])
