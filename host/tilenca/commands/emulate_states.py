"""`tilenca emulate --check-states`: every state of every tile beside the fast simulator's."""

from typing import Any

from tilenca.base.errors import UsageError
from tilenca.emulator.experiment import Emulation
from tilenca.emulator.states import StateWatch
from tilenca.model.file import Model
from tilenca.sweep.replay import Replay

OPTION = "--check-states"


class StateCheck:
    """Compares the states of a run while it goes on.

    Args:
        emulation: that has not begun.
        model: of the firmware; None: it is not at hand.

    Raises:
        UsageError: there is no such model, or the image is none of the tiles' firmware.
    """

    def __init__(self, emulation: Emulation, model: Model | None) -> None:
        if model is None:
            raise UsageError(
                f"{OPTION}: the firmware's model is not among those of this project; give --model DIR"
            )
        self._watch = StateWatch(emulation.array, model.dimensions.channels)
        self._replay = Replay(model, emulation.shape.neighbours())

    def look(self) -> None:
        """Takes what the tiles have computed; call it after every slice of time."""
        for state in self._watch.collect():
            self._replay.take(state)

    def report(self) -> dict[str, Any]:
        """See `Replay.as_json`."""
        return self._replay.as_json()

    def words(self) -> str:
        """The result as a part of a line."""
        told = self.report()
        count = f"{told['states']:,} states, {told['bytes']:,} bytes"
        found = self._replay.difference
        if found is None:
            return f"{count}: the same as the simulator's"
        where = "state" if found.part == "state" else f"message from {found.part}"
        return (
            f"{count}, then the first DIFFERENCE: tile {found.tile}, update {found.update}, {where}, channel "
            f"{found.channel}: {found.on_tile}, in the simulator {found.in_simulator}"
        )
