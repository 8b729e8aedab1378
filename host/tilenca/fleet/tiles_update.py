"""Merges newly learnt tiles into `tiles.toml`: entries of boards that were not seen stay. Pure."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from tilenca.base.errors import TilencaError
from tilenca.fleet.tiles_file import Place, tile_list


@dataclass(frozen=True)
class Update:
    """The new file.

    Attributes:
        places: all its tiles.
        remarks: lines for the person.
    """

    places: list[Place]
    remarks: list[str]


def update(before: Sequence[Place], learnt: Sequence[Place], kept: Sequence[Place], fixed: bool) -> Update:
    """Joins the learnt places with the kept entries.

    The tiles' links give their relative places only: if other entries are kept, the learnt tiles stay where
    they were.

    Args:
        before: the file so far, boards named as in `learnt`.
        learnt: the places found now.
        kept: entries of `before` whose boards were not seen now.
        fixed: whether the learnt places are absolute, not only relative to each other.

    Raises:
        TilencaError: a tile lies at the place of a kept one.
    """
    learnt_ids = {place.tile for place in learnt}
    replaced = [place for place in kept if place.tile in learnt_ids]
    stay = [place for place in kept if place.tile not in learnt_ids]
    remarks = [f"tile {place.tile} was {place.board} before, and is another board now" for place in replaced]
    if stay and not fixed:
        learnt, remark = _aligned(before, learnt, stay)
        remarks += [remark] if remark else []
    taken = {(place.row, place.col): place for place in stay}
    for place in learnt:
        if other := taken.get((place.row, place.col)):
            raise TilencaError(
                f"tile {place.tile} lies where tile {other.tile} ({other.board}), which was not learnt now: "
                f"at {place.row},{place.col}; remove its [[tile]] or connect it, then learn again"
            )
    if stay:
        remarks.append(
            f"kept as they were, since they were not learnt now: {tile_list(p.tile for p in stay)}"
        )
    return Update([*learnt, *stay], remarks)


def _aligned(
    before: Sequence[Place], learnt: Sequence[Place], stay: Sequence[Place]
) -> tuple[list[Place], str]:
    """The learnt places, moved to where most tiles were; tiles without an old place lie beside all others."""
    known = {place.board: place for place in before}
    moves = Counter(
        (known[place.board].row - place.row, known[place.board].col - place.col)
        for place in learnt
        if place.board in known
    )
    if moves:
        (down, right), _ = moves.most_common(1)[0]
        remark = ""
    else:
        down = min(place.row for place in stay) - min(place.row for place in learnt)
        right = max(place.col for place in stay) + 2 - min(place.col for place in learnt)
        remark = (
            f"the place of {tile_list(p.tile for p in learnt)} beside the others is a guess; edit the file"
        )
    return [replace(place, row=place.row + down, col=place.col + right) for place in learnt], remark
