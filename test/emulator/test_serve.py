"""Emulated tiles behind pseudo-terminals: real programs on the other side."""

import os
import re
import select
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Self

import pytest

from support.avr import Compile, run_tool
from support.owned_clock import OwnedClock
from tilenca.emulator.serve import STOCK_BOOTLOADER

TIMEOUT_S = 60.0
FLOW_S = 0.005

ECHO = """
int main(void) {
    UBRR0 = 16; UCSR0A = 2; UCSR0B = 0x18;
    for (const char *text = GREETING; *text; text++) { while (!(UCSR0A & 0x20)) { } UDR0 = *text; }
    for (;;) { while (!(UCSR0A & 0x80)) { } uint8_t c = UDR0; while (!(UCSR0A & 0x20)) { } UDR0 = c ^ 0x20; }
}
"""


class Server:
    def __init__(
        self,
        elf: Path,
        directory: Path,
        *options: str,
        stderr: int = subprocess.PIPE,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        shapes = directory.parent / "pair.toml"
        shapes.write_text('[[shape]]\nlabel = "1"\ngrid = "##"\n')
        command = [sys.executable, "-m", "tilenca.cli", "emulate", "--shapes", shapes, "--elf", elf]
        self.process = subprocess.Popen(
            [*map(str, command), "--boot-spread", "0", "--serve", str(directory), *options],
            stderr=stderr,
            env={**environment, "TERM": "xterm"},
            text=True,
        )
        if stderr != subprocess.PIPE:
            return
        assert self.process.stderr is not None
        assert "serving 2 tiles" in self.process.stderr.readline()

    def stop(self, number: signal.Signals = signal.SIGINT) -> int:
        self.process.send_signal(number)
        return self.process.wait(TIMEOUT_S)


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    return tmp_path / "tiles"


@pytest.fixture
def echo(avr: Compile, directory: Path) -> Iterator[Server]:
    server = Server(avr(ECHO, '-DGREETING="hello "'), directory)
    yield server
    server.stop()


def read(port: int, count: int) -> bytes:
    """Exactly `count` bytes from a port."""
    data = b""
    while len(data) < count:
        ready, _, _ = select.select([port], [], [], TIMEOUT_S)
        assert ready, f"only {data!r} came"
        data += os.read(port, count - len(data))
    return data


def read_until(port: int, wanted: bytes) -> bytes:
    """What comes from a port until `wanted` is among it."""
    data = b""
    while wanted not in data:
        data += read(port, 1)
    return data


def test_bytes_pass_both_ways(echo: Server, directory: Path) -> None:
    assert sorted(path.name for path in directory.iterdir()) == ["tile-01", "tile-02"]
    for name in ("tile-01", "tile-02"):
        port = os.open(directory / name, os.O_RDWR | os.O_NOCTTY)
        assert read(port, 6) == b"hello "  # opening it has reset the tile
        os.write(port, b"abc")
        assert read(port, 3) == b"ABC"
        os.close(port)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_leaves_nothing_behind(echo: Server, directory: Path, number: signal.Signals) -> None:
    assert echo.stop(number) == 130
    assert not directory.exists()


def test_a_second_server_leaves_the_first_one_its_links(echo: Server, directory: Path) -> None:
    before = {path.name: path.readlink() for path in directory.iterdir()}
    command = [sys.executable, "-m", "tilenca.cli", "emulate", "--shape", "1", "--serve", str(directory)]
    second = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    assert (second.returncode, second.stderr.count("\n")) == (2, 1)
    assert "another `tilenca emulate` serves its tiles there" in second.stderr
    assert {path.name: path.readlink() for path in directory.iterdir()} == before


def test_links_of_a_killed_run_are_replaced_and_other_files_kept(avr: Compile, directory: Path) -> None:
    directory.mkdir()
    (directory / "tile-01").symlink_to("/nowhere")
    (directory / "tile-20").symlink_to("/dev/pts/9999")  # of more tiles than now
    (directory / "notes").write_text("mine")
    server = Server(avr(ECHO, '-DGREETING=""'), directory, "--seconds", "0.2")
    assert server.process.wait(TIMEOUT_S) == 0
    assert [path.name for path in directory.iterdir()] == ["notes"]


def test_serving_needs_a_directory_of_its_own() -> None:
    command = [
        sys.executable,
        "-m",
        "tilenca.cli",
        "emulate",
        "--shape",
        "1",
        "--seconds",
        "0.1",
        "--serve",
        "",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "--serve needs a directory of its own" in done.stderr


class Flow:
    """Lets a server's clock flow while the block runs, and leap where the test wants it."""

    def __init__(self, clock: OwnedClock) -> None:
        self._clock = clock
        self._leap_s = 0.0
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *about: object) -> None:
        self._ended.set()
        self._thread.join(TIMEOUT_S)

    def leap(self, seconds: float) -> None:
        """To the server it is as if the machine were busy with something else for so long."""
        self._leap_s = seconds

    def _run(self) -> None:
        while not self._ended.wait(FLOW_S):
            leap_s, self._leap_s = self._leap_s, 0.0
            self._clock.seconds += FLOW_S + leap_s


def greeted(directory: Path, name: str) -> None:
    """Opens a tile's port and waits for its greeting: by then it runs."""
    port = os.open(directory / name, os.O_RDWR | os.O_NOCTTY)
    assert read(port, 6) == b"hello "
    os.close(port)


def test_tiles_that_fall_behind_real_time_say_how_far(avr: Compile, directory: Path, tmp_path: Path) -> None:
    clock = OwnedClock(tmp_path / "clock")
    server = Server(avr(ECHO, '-DGREETING="hello "'), directory, environment=clock.environment)
    with Flow(clock) as flow:
        greeted(directory, "tile-01")
        flow.leap(2.0)
        greeted(directory, "tile-02")
        assert server.stop() == 130
    assert server.process.stderr is not None
    behind = re.search(r"the tiles are ([\d.]+) s behind real time: they ran", server.process.stderr.read())
    assert behind is not None
    assert float(behind[1]) > 1.5


def test_a_terminal_is_told_of_the_lag_while_it_lasts(avr: Compile, directory: Path, tmp_path: Path) -> None:
    clock = OwnedClock(tmp_path / "clock")
    master, slave = os.openpty()
    elf = avr(ECHO, '-DGREETING="hello "')
    server = Server(elf, directory, stderr=slave, environment=clock.environment)
    os.close(slave)
    read_until(master, b"serving 2 tiles")
    with Flow(clock) as flow:
        greeted(directory, "tile-01")
        flow.leap(2.0)
        read_until(master, b"behind real time")
        assert server.process.poll() is None
        server.stop()
    os.close(master)


def test_without_resets_a_tile_runs_on(avr: Compile, directory: Path) -> None:
    server = Server(avr(ECHO, '-DGREETING="hello "'), directory, "--keep-running", "--bootloader", "none")
    port = os.open(directory / "tile-01", os.O_RDWR | os.O_NOCTTY)
    os.write(port, b"abc")
    answer = read(port, 3)
    while answer[-3:] != b"ABC":  # the greeting, if the port was open in time for it
        answer += read(port, 1)
    os.close(port)
    port = os.open(directory / "tile-01", os.O_RDWR | os.O_NOCTTY)
    os.write(port, b"xyz")
    assert read(port, 3) == b"XYZ"
    os.close(port)
    server.stop()


@pytest.mark.skipif(
    not STOCK_BOOTLOADER.exists(), reason="the stock bootloader is in Debian's arduino-core-avr"
)
def test_real_avrdude_programs_a_tile_through_the_stock_bootloader(
    echo: Server, avr: Compile, directory: Path, tmp_path: Path
) -> None:
    assert shutil.which("avrdude"), "avrdude is not installed; run `make setup`"
    replacement = tmp_path / "replacement.hex"
    run_tool("avr-objcopy", "-O", "ihex", avr(ECHO, '-DGREETING="programmed "'), replacement)
    options = ("-p", "atmega2560", "-c", "wiring", "-b", "115200", "-D")
    run_tool("avrdude", *options, "-P", directory / "tile-02", "-U", f"flash:w:{replacement}:i")
    greetings = {"tile-01": b"hello ", "tile-02": b"programmed "}
    for name, greeting in greetings.items():
        port = os.open(directory / name, os.O_RDWR | os.O_NOCTTY)
        assert read(port, len(greeting)) == greeting
        os.close(port)


CHATTER = """
int main(void) {
    UBRR0 = 16; UCSR0A = 2; UCSR0B = 0x18;
    for (uint16_t n = 0;; n++) { while (!(UCSR0A & 0x20)) { } UDR0 = 'a' + n % 26; }
}
"""


def test_a_reader_that_dies_harms_nobody(avr: Compile, directory: Path) -> None:
    server = Server(avr(CHATTER), directory)
    for name in ("tile-01", "tile-02"):
        with subprocess.Popen(["cat", str(directory / name)], stdout=subprocess.PIPE) as reader:
            assert reader.stdout is not None
            assert reader.stdout.read(30)
            reader.kill()  # in the middle of a flood
    again = os.open(directory / "tile-01", os.O_RDWR | os.O_NOCTTY)
    assert b"abcdefghijklmnopqrstuvwxyz" in read(again, 60)
    os.close(again)
    assert server.process.poll() is None
    assert server.stop() == 130


def test_a_reader_that_does_not_read_loses_bytes_and_halts_nobody(avr: Compile, directory: Path) -> None:
    server = Server(avr(CHATTER), directory)
    sleeper = os.open(directory / "tile-01", os.O_RDWR | os.O_NOCTTY)
    other = os.open(directory / "tile-02", os.O_RDWR | os.O_NOCTTY)
    read(other, 12_000)  # more than a pseudo-terminal holds
    assert server.process.poll() is None
    read(sleeper, 3000)
    assert b"abcdefghijklmnopqrstuvwxyz" in read(sleeper, 8000)
    os.close(sleeper)
    os.close(other)
    assert server.stop() == 130


def test_a_program_that_goes_astray_ends_the_run_with_its_place(avr: Compile, directory: Path) -> None:
    source = 'int main(void) { _delay_ms(1200); asm volatile(".word 0xFF0F"); for (;;) { } }'
    # Both tiles get there in the same cycle, so it is always the first that is told.
    server = Server(avr(source), directory, "--bootloader", "none", "--ppm", "0")
    assert server.process.stderr is not None
    said = server.process.stderr.read()
    assert server.process.wait(TIMEOUT_S) == 1
    assert "tile 1 stopped at 0x" in said
    assert "in main: illegal instruction" in said
    assert "Traceback" not in said
    assert not directory.exists()


@pytest.mark.skipif(
    not STOCK_BOOTLOADER.exists(), reason="the stock bootloader is in Debian's arduino-core-avr"
)
def test_two_avrdudes_at_once_program_two_tiles(
    echo: Server, avr: Compile, directory: Path, tmp_path: Path
) -> None:
    options = ("avrdude", "-p", "atmega2560", "-c", "wiring", "-b", "115200", "-D", "-q", "-q")
    running = []
    for number in (1, 2):
        image = tmp_path / f"{number}.hex"
        run_tool("avr-objcopy", "-O", "ihex", avr(ECHO, f'-DGREETING="number {number} "'), image)
        words = [*options, "-P", str(directory / f"tile-0{number}"), "-U", f"flash:w:{image}:i"]
        running.append(subprocess.Popen(words, stderr=subprocess.PIPE, text=True))
    for process in running:
        _, err = process.communicate(timeout=TIMEOUT_S)
        assert process.returncode == 0, err
    for number in (1, 2):
        port = os.open(directory / f"tile-0{number}", os.O_RDWR | os.O_NOCTTY)
        assert read(port, 9) == f"number {number} ".encode()
        os.close(port)
