"""The GDB remote port: byte by byte, and with the real avr-gdb."""

import random
import shutil
import socket
import subprocess
import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from support.avr import Compile
from tilenca.base.errors import TilencaError, UsageError
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array
from tilenca.emulator.gdb import GdbPort

TIMEOUT_S = 60.0

PROGRAM = """
volatile uint16_t count;
volatile uint8_t table[4] = {1, 2, 3, 4};
__attribute__((noinline)) void turn(uint16_t by) { count += by; }
int main(void) { for (;;) { turn(3); _delay_us(50); } }
"""


class Debugger:
    """The other end, as far as a test needs it."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), TIMEOUT_S)
        self.rest = b""

    def send(self, packet: str) -> None:
        self.socket.sendall(f"${packet}#{sum(packet.encode()) % 256:02x}".encode())

    def receive(self) -> str:
        while b"#" not in self.rest or len(self.rest.partition(b"#")[2]) < 2:
            data = self.socket.recv(4096)
            assert data, f"the port was closed after {self.rest!r}"
            self.rest += data
        body, _, after = self.rest.partition(b"#")
        self.rest = after[2:]
        text = body.partition(b"$")[2]
        assert int(after[:2], 16) == sum(text) % 256
        return text.decode()

    def ask(self, packet: str) -> str:
        self.send(packet)
        return self.receive()


@pytest.fixture
def array(avr: Compile) -> Iterator[Array]:
    links = [(tile, EAST, tile + 1, WEST) for tile in range(19)]
    with Array(avr(PROGRAM, "-g"), 20, links) as tiles:
        yield tiles


@pytest.fixture
def port(array: Array) -> Iterator[GdbPort]:
    """A port of tile 7, in use by an array that runs in another thread until the debugger goes."""
    served = GdbPort(array, array[6])

    def run() -> None:
        served.wait()
        while served.connected:
            served.run(0.001)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    yield served
    thread.join(TIMEOUT_S)
    assert not thread.is_alive()
    served.close()


def test_a_debugger_reads_writes_steps_and_breaks(array: Array, port: GdbPort) -> None:
    turn, (count, _), (table, _) = array.symbol("turn")[0], array.symbol("count"), array.symbol("table")
    gdb = Debugger(port.port)
    assert gdb.ask("?") == "S05"
    assert gdb.ask("qSupported:swbreak+").startswith("PacketSize=")
    assert gdb.ask(f"Z0,{turn:x},2") == "OK"
    assert gdb.ask("c") == "S05"
    assert int.from_bytes(bytes.fromhex(gdb.ask("g"))[35:39], "little") == turn
    assert gdb.ask("p18") == "03"  # r24: the argument
    assert gdb.ask(f"m{table:x},4") == "01020304"
    assert gdb.ask(f"M{count:x},2:0001") == "OK"
    assert gdb.ask("c") == "S05"
    assert gdb.ask(f"m{count:x},2") == "0301"
    assert gdb.ask("s") == "S05"
    assert int.from_bytes(bytes.fromhex(gdb.ask("p22")), "little") in (turn + 2, turn + 4)
    assert gdb.ask(f"z0,{turn:x},2") == "OK"
    gdb.send("c")
    gdb.socket.sendall(b"\x03")
    assert gdb.receive() == "S02"
    assert gdb.ask("P18=7f") == "OK"
    assert gdb.ask("p18") == "7f"
    assert gdb.ask("Z2,800200,1") == ""  # watchpoints: GDB steps instead
    assert gdb.ask("m0,2") == array[6].read_flash(0, 2).hex()
    assert gdb.ask("M0,1:00") == "E01"
    assert gdb.ask("mzz,1") == "E01"
    assert gdb.ask("qRcmd," + b"reset".hex()) == "OK"
    assert gdb.ask("p22") == "00000000"
    assert gdb.ask("D") == "OK"


def test_damaged_packets_are_asked_for_again(port: GdbPort) -> None:
    gdb = Debugger(port.port)
    gdb.socket.sendall(b"+$?#00")
    assert gdb.socket.recv(1) == b"-"
    gdb.socket.sendall(b"$?#zz")
    assert gdb.socket.recv(1) == b"-"
    assert gdb.ask("?") == "S05"
    gdb.socket.close()


def test_senseless_packets_are_answered_and_survived(port: GdbPort) -> None:
    draw = random.Random(3)
    gdb = Debugger(port.port)
    letters = "gGpPmMZzHTqvX?!Rbti0123456789abcdef,:;=+$ "
    for _ in range(300):
        body = "".join(draw.choice(letters) for _ in range(draw.randrange(1, 12)))
        if body[0] in "mM":
            address = draw.choice([0, 0x3FFFF, 0x800000, 0x8021FF, 0x810FFF, 0x811000, 2**32])
            body = f"{body[0]}{address:x},{draw.choice([0, 1, 9999]):x}:"
        packet = body.replace("$", "").replace("+", "").lstrip("c") or "?"  # c: the tile would go on
        answer = gdb.ask(packet)
        assert "#" not in answer
    assert gdb.ask("?") == "S05"
    gdb.socket.close()


def test_a_breakpoint_halts_one_tile_and_changes_nothing(avr: Compile, array: Array) -> None:
    undisturbed = Array(avr(PROGRAM, "-g"), 20, [(tile, EAST, tile + 1, WEST) for tile in range(19)])
    undisturbed.run(0.01)
    array[6].set_breakpoint("turn")
    halts = 0
    while array.time_s < 0.01 - 1e-6:
        array.run(0.01 - array.time_s)
        if array.halted:
            assert [tile.index for tile in array.halted] == [6]
            assert array[6].pc == array.symbol("turn")[0]
            halts += 1
            array[6].resume()
    array[6].set_breakpoint("turn", False)
    array.run(1e-6)
    undisturbed.run(array.time_s - undisturbed.time_s)
    assert halts == array[6].integer("count") // 3
    for tile, other in zip(array, undisturbed, strict=True):
        assert (tile.cycles, tile.read_memory(0, 0x2200)) == (other.cycles, other.read_memory(0, 0x2200))


def test_a_fault_is_told_to_the_debugger(avr: Compile) -> None:
    array = Array(avr('int main(void) { _delay_us(50); asm volatile(".word 0xFF0F"); }'))
    port = GdbPort(array, array[0])

    def run() -> None:
        port.wait()
        with suppress(TilencaError):  # with the debugger gone, the fault is the caller's
            while port.connected:
                port.run(0.001)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    gdb = Debugger(port.port)
    told = gdb.ask("c")
    assert told.startswith("O")
    assert "illegal instruction" in bytes.fromhex(told[1:]).decode()
    assert gdb.receive() == "S04"
    gdb.socket.close()
    thread.join(TIMEOUT_S)
    port.close()


def test_a_port_in_use_is_refused(array: Array) -> None:
    first = GdbPort(array, array[0])
    with pytest.raises(UsageError, match="give another"):
        GdbPort(array, array[1], first.port)
    first.close()


@pytest.mark.skipif(shutil.which("avr-gdb") is None, reason="avr-gdb is in Debian's gdb-avr")
def test_real_avr_gdb_stops_tile_7_of_20(port: GdbPort, tmp_path: Path) -> None:
    commands = [
        "set pagination off", f"target remote :{port.port}", "break turn", "continue", "print by",
        "print count", "continue", "print count", "stepi", "backtrace", "print/x table", "detach",
    ]  # fmt: skip
    words = ["avr-gdb", "-batch", "-nx", str(tmp_path / "program.elf")]
    for command in commands:
        words += ["-ex", command]
    said = subprocess.run(words, capture_output=True, text=True, timeout=TIMEOUT_S, check=False).stdout
    assert "Breakpoint 1, turn (by=3)" in said
    assert "$1 = 3\n$2 = 0\n" in said
    assert "$3 = 3\n" in said
    assert "#1 " in said
    assert " main () at " in said
    assert "$4 = {0x1, 0x2, 0x3, 0x4}" in said
