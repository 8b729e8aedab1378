"""What `tiles.toml` says after tiles were learnt anew: entries of boards not seen stay. Pure."""

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
        remarks: what a person should know, a line each.
    """

    places: list[Place]
    remarks: list[str]


def update(before: Sequence[Place], learnt: Sequence[Place], kept: Sequence[Place], fixed: bool) -> Update:
    """Joins what was learnt with what is kept.

    What tiles say of their neighbours leaves open where all of them lie: beside what is kept, they stay where
    they were.

    Args:
        before: the file so far, boards named as in `learnt`.
        learnt: what was found out now.
        kept: entries of `before` whose boards were not among those.
        fixed: whether the learnt places are where tiles lie, not only how they lie to each other.

    Raises:
        TilencaError: a tile lies where one that is kept does.
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
    """What was learnt, moved to where most of it was; what was nowhere lies beside all else."""
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
