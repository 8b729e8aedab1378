"""The outcome of each board that was flashed, as a table or a document."""

import json
from collections.abc import Sequence
from dataclasses import dataclass

from tilenca.base.stdio import warn
from tilenca.fleet.identify import Answer
from tilenca.views.table import table

GOOD = {"flashed", "skipped"}
HEADER = ("PORT", "TILE", "RESULT", "SECONDS", "FIRMWARE", "WHY")


@dataclass
class FlashRow:
    """The outcome of one tile: `board` is its name in `tiles.toml`, `firmware_id` the firmware it reports."""

    port: str | None
    result: str = "interrupted"
    seconds: float = 0.0
    error: str | None = "interrupted; flash it again"
    tile: int | None = None
    board: str = ""
    attempts: int = 0
    firmware_id: str | None = None

    def end(self, result: str, error: str | None = None) -> None:
        """Sets the outcome."""
        self.result, self.error = result, error

    def hear(self, answer: Answer) -> None:
        """Takes the tile's own greeting."""
        if answer.hello:
            self.firmware_id = f"{answer.hello.firmware_id:08X}"
            self.tile = self.tile or answer.hello.tile or None

    @property
    def cells(self) -> list[str]:
        """Its row under HEADER; without seconds if avrdude was never started."""
        seconds = f"{self.seconds:.1f}" if self.attempts else "-"
        tile = str(self.tile or "-")
        why = "runs this image already" if self.result == "skipped" else self.error or ""
        return [self.port or "-", tile, self.result, seconds, self.firmware_id or "-", why]


def tell(rows: Sequence[FlashRow], as_json: bool) -> None:
    """Prints the outcomes, and how many boards were flashed."""
    if as_json:
        print(json.dumps({"tiles": [vars(row) for row in rows]}, indent=2))
    elif rows:
        print(table(HEADER, [row.cells for row in rows]))
    if rows:
        results = [row.result for row in rows]
        skipped = f", {results.count('skipped')} ran it already" if "skipped" in results else ""
        warn(f"{results.count('flashed')} of {len(results)} flashed{skipped}")
