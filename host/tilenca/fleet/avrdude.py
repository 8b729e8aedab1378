"""avrdude: finds it, builds its command line, and turns its output into a reason and a remedy."""

import os
import re
import shutil
from collections import deque
from dataclasses import dataclass
from pathlib import Path

from tilenca.base import paths
from tilenca.base.errors import TilencaError
from tilenca.fleet import ports
from tilenca.fleet.lock import holders

PART = "m2560"
PROGRAMMER = "wiring"
BAUD = 115200
SIGNATURE = "0x1e9801"

# avrdude's bars have a mark for every 2 %, on a terminal or not.
MARKS = 50

# 6.3 says "can't open device", 7.1 "cannot open port".
CANNOT_OPEN = re.compile(r"can(?:no|')t open (?:port|device)")

SIGNATURE_LINE = re.compile(r"[Dd]evice signature = (0x[0-9a-fA-F]{6})")

NO_REPLY = (
    "no reply from a Mega's bootloader; is this a Mega 2560? "
    "Reconnect its USB cable or press its reset, then flash it again"
)
GONE = "the board went away; connect it and flash it again, its bootloader is intact"


@dataclass(frozen=True)
class Avrdude:
    """The program, and its configuration file where the program does not find that by itself."""

    program: Path
    config: Path | None = None

    def command(self, port: str, image: Path) -> list[str]:
        """The command line that writes `image` to the board at `port` and reads it back.

        -D: the stock bootloader erases page by page and knows no chip erase.
        """
        config = ["-C", str(self.config)] if self.config else []
        board = ["-c", PROGRAMMER, "-p", PART, "-P", port, "-b", str(BAUD), "-D"]
        return [str(self.program), *config, *board, "-U", f"flash:w:{image}:i"]


def find_avrdude() -> Avrdude:
    """Avrdude from the PATH, else the one PlatformIO installed.

    Raises:
        TilencaError: there is none.
    """
    if found := shutil.which("avrdude"):
        return Avrdude(Path(found))
    core_dirs = [
        os.environ.get("PLATFORMIO_CORE_DIR"),
        paths.BUILD / "platformio",
        Path.home() / ".platformio",
    ]
    for core_dir in (Path(folder) for folder in core_dirs if folder):
        package = core_dir / "packages" / "tool-avrdude"
        for program in (package / "bin" / "avrdude", package / "avrdude"):
            if os.access(program, os.X_OK) and program.is_file():
                config = package / "avrdude.conf"
                return Avrdude(program, config if config.is_file() else None)
    raise TilencaError(
        "avrdude is not installed; `sudo apt-get install avrdude`, or `pio pkg install -g -t tool-avrdude`"
    )


@dataclass(frozen=True)
class Progress:
    """The progress of a board: `phase` is connecting, writing or verifying, `share` 0..1 of that phase."""

    phase: str
    share: float


class Output:
    """Parses avrdude's output: bytes in, progress and finally a reason out.

    avrdude announces a phase as `Writing | ` and then prints one `#` for every 2 % of it.
    """

    def __init__(self) -> None:
        self.progress = Progress("connecting", 0.0)
        self.lines: deque[str] = deque(maxlen=200)
        self._partial = ""
        self._bars = 0

    def feed(self, data: bytes) -> None:
        """Takes the next bytes of avrdude's standard error."""
        *complete, self._partial = (self._partial + data.decode("utf-8", "replace")).split("\n")
        self._partial = self._partial[-1000:]
        for line in complete:
            self._look(line)
            self.lines.append(line.strip())
        self._look(self._partial)

    def _look(self, line: str) -> None:
        if not (bar := re.match(r"\s*(Reading|Writing) \| *(#*)", line.rpartition("\r")[2])):
            return
        share = min(len(bar[2]) / MARKS, 1.0)
        if bar[1] == "Writing":
            self.progress = Progress("writing", share)
        elif self.progress.phase != "connecting":
            # Before the first write, avrdude reads the chip's signature.
            self.progress = Progress("verifying", share)

    @property
    def text(self) -> str:
        """The kept part of the output."""
        return "\n".join([*self.lines, self._partial])

    @property
    def hopeless(self) -> bool:
        """Whether it can only fail now: avrdude 7.1 loops for ever on a port that it could not open."""
        # Only whole lines: the reason stands at their end.
        return CANNOT_OPEN.search("\n".join(self.lines)) is not None

    @property
    def passing(self) -> bool:
        """Whether another attempt could succeed."""
        signature = SIGNATURE_LINE.search(self.text)
        return not self.hopeless and (signature is None or signature[1].lower() == SIGNATURE)

    def reason(self, port: str) -> str:
        """One line for the user: the fault and the remedy."""
        text = self.text
        if self.hopeless:
            return _cannot_open(text, port)
        signature = SIGNATURE_LINE.search(text)
        if signature and signature[1].lower() != SIGNATURE:
            return (
                f"wrong chip: its signature is {signature[1]}, an ATmega2560's is {SIGNATURE}; "
                "is this a tile? Name the tiles with --port"
            )
        # 6.3 says "first mismatch at byte 0x12", 7.1 "device 0x01 != input 0x02 at addr 0x12".
        if mismatch := re.search(r"verification (?:error|mismatch).*?(?:byte|addr) (0x\w+)", text, re.DOTALL):
            return f"verification failed at {mismatch[1]}; flash it again, and if it repeats change the cable"
        if not Path(port).exists() or re.search(r"(Input/output error|No such device)", text):
            return GONE
        if re.search(r"timeout|not in sync|cannot get into sync|not responding", text):
            return NO_REPLY
        complaints = [line for line in self.lines if "error" in line.lower() and "TIOCMGET" not in line]
        last = (
            complaints[-1]
            if complaints
            else next((line for line in reversed(self.lines) if line), "no message")
        )
        return f"avrdude failed: {last.removeprefix('avrdude ')}"


def _cannot_open(text: str, port: str) -> str:
    if "No such file" in text:
        return "no such port; is the board connected?"
    if "Permission denied" in text:
        return ports.denial(port) or "permission denied"
    if "busy" in text:
        holder = holders([port]).get(port, "another program")
        return f"busy: {holder} has it open; close that, then flash again"
    # Both versions end the line with the system's reason: `... port /dev/ttyACM0: Some reason`.
    line = next(line for line in text.splitlines() if CANNOT_OPEN.search(line))
    return f"cannot be opened: {line.rpartition(': ')[2]}; is it a serial port?"
