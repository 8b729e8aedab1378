"""Measures the monitor's share of a core, and the sentences that it loses: bench.fleet.

Tiles are pseudo-terminals that speak at a steady pace; the monitor is the real command, with a live picture
and a recording, which is compared with the sentences sent.
"""

import argparse
import os
import pty
import subprocess
import sys
import tempfile
import termios
import threading
import time
import tty
from contextlib import suppress
from pathlib import Path

from tilenca.fleet.recording import read_recording
from tilenca.protocol.line_reader import Heard
from tilenca.protocol.sentences import LinkSentence, TileSentence, TimeSentence, format_sentence

COLUMNS = 5
STATE = bytes([128] * 21)
FACING = dict(zip("NESW", "SWNE", strict=True))
TILE_OFFSETS = {"N": -COLUMNS, "E": 1, "S": COLUMNS, "W": -1}
READY_S = 3.0


def neighbour(tile: int, side: str, count: int) -> int | None:
    """The tile on a side, in rows of COLUMNS; tiles count from 1."""
    other = tile + TILE_OFFSETS[side]
    if not 1 <= other <= count or (side in "EW" and (other - 1) // COLUMNS != (tile - 1) // COLUMNS):
        return None
    return other


def sentence(tile: int, number: int, rate: float, count: int) -> bytes:
    """A tile's sentence with this number: in turn its state and a side, at intervals its times."""
    uptime_ms = round(number * 1000 / rate)
    beside = {side: neighbour(tile, side, count) for side in "NESW"}
    if number % 2 == 0:
        links = "".join("-" if other is None else side for side, other in beside.items())
        label = str(number // 200 % 10)
        return format_sentence(TileSentence(tile, uptime_ms, number, label, int(label), 30, links, STATE))
    if number % 20 == 1:
        return format_sentence(TimeSentence(tile, uptime_ms, 9000, 700, number, 3000, 0))
    side = "NESW"[number // 2 % 4]
    other = beside[side]
    heard = (9, 0, other, FACING[side]) if other else (None, 0, None, None)
    return format_sentence(LinkSentence(tile, uptime_ms, side, number, number, 0, 0, 0, *heard))


def speak(masters: list[int], rate: float, seconds: float) -> tuple[list[int], int]:
    """Writes `rate` sentences a second to each port; returns the taken of each and the dropped of all."""
    sent, refused = [0] * len(masters), 0
    started_s = time.monotonic()
    for number in range(round(rate * seconds)):
        time.sleep(max(0.0, started_s + number / rate - time.monotonic()))
        for index, master in enumerate(masters):
            try:
                os.write(master, sentence(index + 1, number, rate, len(masters)))
                sent[index] += 1
            except BlockingIOError:
                refused += 1
    return sent, refused


def watch(count: int, rate: float, seconds: float) -> str:
    """One line: the monitor's share of a core, and its lost sentences."""
    pairs = [os.openpty() for _ in range(count)]
    for master, slave in pairs:
        tty.setraw(slave)
        os.set_blocking(master, False)
    screen, inside = pty.openpty()
    termios.tcsetwinsize(inside, (50, 160))
    drain = threading.Thread(target=_drain, args=(screen,), daemon=True)
    drain.start()
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder) / "record.jsonl"
        ports = [word for _, slave in pairs for word in ("--port", os.ttyname(slave))]
        length = ["--seconds", str(seconds + 2 * READY_S)]
        command = [sys.executable, "-m", "tilenca.cli", "monitor", "--record", str(record), *length, *ports]
        environment = {**os.environ, "TERM": "xterm-256color"}
        with subprocess.Popen(command, stdout=inside, stderr=subprocess.DEVNULL, env=environment) as monitor:
            time.sleep(READY_S)
            idle_s = _cpu_s(monitor.pid)
            began_s = time.monotonic()
            sent, refused = speak([master for master, _ in pairs], rate, seconds)
            wall_s, cpu_s = time.monotonic() - began_s, _cpu_s(monitor.pid) - idle_s
            monitor.wait()
        good = sum(
            isinstance(event, Heard) and event.sentence is not None for event in read_recording(record)
        )
    for pair in pairs:
        os.close(pair[0])
        os.close(pair[1])
    os.close(inside)
    lost = sum(sent) - good + refused
    return (
        f"{count:>4} tiles x {sum(sent) / count / wall_s:.1f} sentences/s: {cpu_s / wall_s:.1%} of a core, "
        f"{good:,} of {sum(sent) + refused:,} recorded, {lost} lost"
    )


def _cpu_s(pid: int) -> float:
    """Processor time of a process so far, in user and system mode."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _drain(screen: int) -> None:
    """Reads the picture, as a terminal does."""
    with suppress(OSError):  # Linux's way to say that the other end is closed
        while os.read(screen, 65536):
            pass
    os.close(screen)


def main() -> None:
    """Prints a line for 20 tiles and one for 100."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="how long tiles speak (default: 20)")
    parser.add_argument("--rate", type=float, default=20.0, help="sentences a second of each (default: 20)")
    args = parser.parse_args()
    for count in (20, 100):
        print(watch(count, args.rate, args.seconds), flush=True)


if __name__ == "__main__":
    main()
