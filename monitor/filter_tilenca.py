"""Makes `pio device monitor` show a tile's sentences in words; `--raw` or `-f direct` shows them raw."""

import sys
from pathlib import Path

from platformio.device.monitor.filters.base import DeviceMonitorFilterBase

HOST = str(Path(__file__).resolve().parents[1] / "host")
if HOST not in sys.path:
    sys.path.append(HOST)  # PlatformIO may run in another environment than the package's

from tilenca.protocol.board_test import board_test_text  # noqa: E402
from tilenca.protocol.describe import printable, said  # noqa: E402
from tilenca.protocol.line_reader import LineReader  # noqa: E402


class Tilenca(DeviceMonitorFilterBase):
    """One line of words for every sentence; the board test's text unchanged; damaged lines marked."""

    NAME = "tilenca"

    def __init__(self, options: dict[str, object] | None = None) -> None:
        """Takes PlatformIO's options, of which it needs none."""
        super().__init__(options)
        self._lines = LineReader()

    def rx(self, text: str) -> str:
        """The words of the sentences that `text` completes; miniterm may have replaced other bytes."""
        heard = self._lines.feed(text.encode("ascii", "replace"))
        return "".join(
            (said(sentence) if sentence else board_test_text(raw) or f"DAMAGED {printable(raw)}") + "\r\n"
            for raw, sentence in heard
        )
