"""Writes the cases that the C++ and the Python tests share: `python test/vectors/make_vectors.py`.

Everything here is written a second time, from docs/PROTOCOL.md and as plainly as possible, so that a mistake
in one of the twins is not in its expectations too. Only numpy is used; nothing of tilenca is imported.

The files are lists of `CASE(...)`, which C++ includes behind a macro and Python reads with a regular
expression.
"""

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

HERE = Path(__file__).parent
HEADER = "// Written by make_vectors.py; do not edit.\n"


def crc(data: bytes) -> int:
    """CRC-16/IBM-3740, one bit at a time."""
    register = 0xFFFF
    for byte in data:
        for bit in range(7, -1, -1):
            feedback = (register >> 15) ^ (byte >> bit & 1)
            register = (register << 1 & 0xFFFF) ^ (0x1021 if feedback else 0)
    return register


def cobs(payload: bytes) -> bytes:
    """COBS of a payload shorter than 254 bytes: each zero's place holds the way to the next one."""
    chain = bytearray(b"\0" + payload + b"\0")
    zeros = [index for index, byte in enumerate(chain) if byte == 0]
    for here, there in pairwise(zeros):
        chain[here] = there - here
    return bytes(chain[:-1])


def payload(
    side: int,
    tile: int,
    sequence: int,
    model: int,
    messages: Sequence[int],
    first: int = 0x30,
    bad_crc: int = 0,
) -> bytes:
    """A frame's payload; `first` and `bad_crc` damage it on purpose."""
    head = [first | side, tile, sequence, model & 0xFF, model >> 8]
    body = bytes([*head, *(message + 128 for message in messages)])
    check = crc(body) ^ bad_crc
    return body + bytes([check & 0xFF, check >> 8])


def frame(*args: int | Sequence[int], **damage: int) -> bytes:
    """The payload as it goes on the wire."""
    return cobs(payload(*args, **damage)) + b"\0"  # type: ignore[arg-type]


def ready(side: int, tile: int, sequence: int, model: int, messages: Sequence[int]) -> str:
    """The event of a good frame."""
    return " ".join(["ready", "NESW"[side], str(tile), str(sequence), f"{model:04X}", *map(str, messages)])


def frame_cases() -> list[tuple[str, int, bytes, list[str]]]:
    """(name, channels the decoder expects, bytes of the line, events) of every case."""
    one = (2, 12, 7, 0xBEEF, (1, -2, 3))
    two = (2, 12, 8, 0xBEEF, (-127, 0, 127))
    good, after = frame(*one), frame(*two)
    ok, then = ready(*one), ready(*two)
    wide = (3, 255, 255, 0x1234, tuple(range(-10, 11)))
    widest = (1, 0, 0, 0xFFFF, tuple(range(-127, -76)))
    flipped = bytes([good[0] ^ 0x04]) + good[1:]
    return [
        ("good frame", 3, good, [ok]),
        ("greatest and least messages", 3, after, [then]),
        (
            "every other byte of the header is zero",
            3,
            frame(0, 0, 0, 0, (5, 6, 7)),
            [ready(0, 0, 0, 0, (5, 6, 7))],
        ),
        ("frame of the shipped model's size", 21, frame(*wide), [ready(*wide)]),
        ("frame of the greatest size", 51, frame(*widest), [ready(*widest)]),
        ("two frames without a pause", 3, good + after, [ok, then]),
        ("zero bytes in between are nothing", 3, b"\0\0" + good + b"\0\0\0" + after + b"\0", [ok, then]),
        ("nothing but zero bytes", 3, b"\0" * 9, []),
        ("another model is a good frame", 3, frame(0, 1, 7, 1, (1, 2, 3)), [ready(0, 1, 7, 1, (1, 2, 3))]),
        ("start in the middle, next frame survives", 3, good[4:] + after, ["corrupt", then]),
        ("truncated, next frame survives", 3, good[:-3] + b"\0" + after, ["corrupt", then]),
        ("delimiter lost, next but one survives", 3, good[:-1] + good + after, ["corrupt", then]),
        ("one byte lost, next frame survives", 3, good[:5] + good[6:] + after, ["corrupt", then]),
        ("one byte doubled, next frame survives", 3, good[:5] + good[4:] + after, ["corrupt", then]),
        (
            "too long, next frame survives",
            3,
            frame(2, 12, 7, 0xBEEF, (1, 2, 3, 4)) + after,
            ["corrupt", then],
        ),
        ("too short, next frame survives", 3, frame(2, 12, 7, 0xBEEF, (1, 2)) + after, ["corrupt", then]),
        ("300 bytes without a delimiter, next survives", 3, b"\x55" * 300 + b"\0" + after, ["corrupt", then]),
        ("256 bytes more than a frame, next survives", 3, b"\1" * 256 + good + after, ["corrupt", then]),
        ("bad crc, next frame survives", 3, frame(*one, bad_crc=0x0100) + after, ["corrupt", then]),
        ("version 2 with a good crc", 3, frame(*one, first=0x20) + after, ["corrupt", then]),
        ("version 4 with a good crc", 3, frame(*one, first=0x40) + after, ["corrupt", then]),
        ("wrong kind with a good crc", 3, frame(*one, first=0x34) + after, ["corrupt", then]),
        ("message -128 with a good crc", 3, frame(2, 12, 7, 0xBEEF, (1, -128, 3)) + after, ["corrupt", then]),
        ("bit flipped in the cobs code", 3, flipped + after, ["corrupt", then]),
        ("cobs code beyond the end", 3, b"\x20" + good[1:] + after, ["corrupt", then]),
        ("cobs code that would come round again", 3, b"\1" + b"\xff" * 9 + b"\0" + after, ["corrupt", then]),
        ("single byte", 3, b"\1\0" + after, ["corrupt", then]),
        ("no delimiter yet", 3, good[:-1], []),
    ]


def settings_cases() -> list[tuple[str, bytes, str]]:
    """(name, block in EEPROM, what it means) of every case."""

    def block(
        tile: int,
        period: int,
        updates: int,
        light: int,
        magic: bytes = b"TN\2",
        rest: int = 0,
        bad_crc: int = 0,
    ) -> bytes:
        numbers = [tile, period & 0xFF, period >> 8, updates & 0xFF, updates >> 8, light, rest]
        body = magic + bytes(numbers)
        check = crc(body) ^ bad_crc
        return body + bytes([check & 0xFF, check >> 8])

    paper = (7, 2000, 30, 128)
    return [
        ("the paper's", block(*paper), "7 2000 30 128 1"),
        ("no id, shortest period, for ever, dark", block(0, 10, 0, 0), "0 10 0 0 1"),
        ("greatest values", block(255, 10000, 65535, 255), "255 10000 65535 255 1"),
        ("erased", b"\xff" * 12, "ignored"),
        ("zeros", b"\0" * 12, "ignored"),
        ("period too short", block(7, 9, 30, 128), "ignored"),
        ("period too long", block(7, 10001, 30, 128), "ignored"),
        ("wrong magic", block(*paper, magic=b"NT\2"), "ignored"),
        ("version 1", block(*paper, magic=b"TN\1"), "ignored"),
        ("version 1's shorter block", block(*paper, magic=b"TN\1")[:10] + b"\xff\xff", "ignored"),
        ("link LEDs off", block(*paper, rest=1), "7 2000 30 128 0"),
        ("link LEDs show what is missing", block(*paper, rest=2), "7 2000 30 128 2"),
        ("link LEDs show what nobody knows", block(*paper, rest=3), "ignored"),
        ("bit flipped in the crc", block(*paper, bad_crc=1), "ignored"),
        ("bit flipped in the updates", block(*paper)[:6] + b"\x1f" + block(*paper)[7:], "ignored"),
    ]


def sentence_cases() -> list[tuple[str, str]]:
    """(name, text between `$` and `*`) of every case; the tests of both twins know the values behind them."""
    return [
        ("hello of tile 7", "HELLO,3,7,BEEF,3,2,2000,30,0A,00C0FFEE,128"),
        ("hello of a tile with directions", "HELLO,3,7,BEEF,3,2,2000,30,0A,00C0FFEE,128,4"),
        ("tile before its first update", "TILE,0,0,0,,,,----,C08080"),
        ("tile after its first update", "TILE,255,4294967295,1,4,0,30,N-S-,C08A6C"),
        ("link that never heard a frame", "LINK,7,5,W,0,0,0,0,0,,0,,"),
        ("link with a corrupt frame", "LINK,7,300,E,1,3,1,0,0,210,12,200,W"),
        ("time", "TIME,7,1000,14200,163,2048,5000,3"),
        ("chip", "CHIP,7,FF,D8,FD,CF,,"),
        ("chip on a marked board", "CHIP,7,FF,D8,FD,CF,2,1017"),
        ("board whose supply is not known", "BOARD,7,500,,0,0,0,0,0,0,0,0"),
        ("board with a line that is low", "BOARD,7,60500,4380,1,0,65535,12,0,0,60000,4294967295"),
        ("error of a low supply", "ERROR,7,1500,SUPPLY,4380 mV"),
        ("error without an address", "ERROR,7,12,SETTINGS,defaults in force"),
        ("error with an address", "ERROR,0,3,WATCHDOG,hung at 0x00A2C"),
        ("answer to a period", "ACK,7,SET,period,20"),
        ("answer to a preset", "ACK,7,SET,preset,paper"),
        ("answer to a new id", "ACK,9,SET,id,9"),
        ("answer to a marking", "ACK,7,MARK,2,1017"),
        ("a marking that is for good", "NAK,7,MARKED,MARK"),
        ("answer to blink", "ACK,7,BLINK,5"),
        ("answer to restart", "ACK,7,RESTART"),
        ("a damaged command", "NAK,7,CHECKSUM,"),
        ("a command too long", "NAK,7,LONG,"),
        ("a command nobody knows", "NAK,7,UNKNOWN,FLY"),
        ("a value out of range", "NAK,7,VALUE,SET"),
        ("an EEPROM that does not keep", "NAK,7,EEPROM,SET"),
    ]


def framed(text: str) -> str:
    """A sentence from `$` to its checksum."""
    xor = int(np.bitwise_xor.reduce(np.frombuffer(text.encode("latin-1"), np.uint8))) if text else 0
    return f"${text}*{xor:02X}"


def command_cases() -> list[tuple[str, bytes, list[str]]]:
    """(name, bytes from the host, events) of every case: `ok` and the good command, or what is wrong."""

    def line(text: str) -> bytes:
        return framed(text).encode("latin-1") + b"\r\n"

    ask, asked = line("ASK"), "ok ASK"
    longest = "SET," + "x" * 54
    return [
        ("ask", ask, [asked]),
        ("set", line("SET,period,20"), ["ok SET,period,20"]),
        ("preset", line("SET,preset,paper"), ["ok SET,preset,paper"]),
        ("blink", line("BLINK,60"), ["ok BLINK,60"]),
        ("restart", line("RESTART"), ["ok RESTART"]),
        ("chip", line("CHIP"), ["ok CHIP"]),
        ("without an end of line", ask[:-2] + ask[:-2], [asked, asked]),
        ("garbage in between", b"\0\xffAT\r\n*00" + ask + b"hello" + ask, [asked, asked]),
        ("empty", b"$*00\r\n", ["ok "]),
        ("empty fields", line("SET,,"), ["ok SET,,"]),
        ("the longest", line(longest), ["ok " + longest]),
        ("one byte too long, then good", line(longest + "x") + ask, ["LONG", asked]),
        ("endless, then good", b"$" + b"y" * 300 + ask, ["LONG", asked]),
        ("wrong checksum, then good", b"$ASK*58\r\n" + ask, ["CHECKSUM", asked]),
        ("checksum in lower case", line("SET,id,3").lower().replace(b"set", b"SET"), ["CHECKSUM"]),
        ("checksum is no number", b"$ASK*5G" + ask, ["CHECKSUM", asked]),
        ("line ends in the middle", b"$SET,id\r\n" + ask, ["CHECKSUM", asked]),
        ("line ends before the checksum", b"$ASK*\r\n" + ask, ["CHECKSUM", asked]),
        ("begun anew", b"$SET,per" + ask, ["CHECKSUM", asked]),
        ("begun anew in the checksum", b"$ASK*5" + ask, ["CHECKSUM", asked]),
        ("nothing but beginnings", b"$$$$" + ask, [asked]),
        ("a byte that no text has", line("A\x01K") + ask, ["CHECKSUM", asked]),
        ("a byte beyond ASCII", line("A\xe9K") + ask, ["CHECKSUM", asked]),
        ("not at its end yet", b"$SET,id,7*3", []),
    ]


class Numbers:
    """Random integers that the C++ test draws too: xorshift32."""

    def __init__(self, seed: int) -> None:
        self._state = seed

    def draw(self, low: int, high: int) -> int:
        """The next one, low..high."""
        state = self._state
        state ^= state << 13 & 0xFFFFFFFF
        state ^= state >> 17
        state ^= state << 5 & 0xFFFFFFFF
        self._state = state
        return low + state % (high - low + 1)

    def array(self, low: int, high: int, *shape: int) -> NDArray[np.int64]:
        """An array of them in row-major order."""
        return np.array([self.draw(low, high) for _ in range(int(np.prod(shape)))]).reshape(shape)


def run_network(
    channels: int, hidden1: int, hidden2: int, seed: int, reach: int, updates: int
) -> tuple[str, int]:
    """Runs one cell with random weights on random neighbours; docs/PROTOCOL.md section 4 in int64.

    Args:
        channels: C.
        hidden1: H1.
        hidden2: H2.
        seed: of the weights, then of the neighbours' messages, in this order.
        reach: weights are -reach..reach, biases up to 128 times that.
        updates: how many.

    Returns:
        The state after the first update as text, and the CRC of all states (little-endian) one after another.
    """
    numbers = Numbers(seed)
    widths = [(hidden1, 5 * channels), (hidden2, hidden1), (channels, hidden2)]
    layers = [
        (numbers.array(-reach, reach, *width), numbers.array(-128 * reach, 128 * reach, width[0]))
        for width in widths
    ]
    state = np.zeros(channels, dtype=np.int64)
    state[0] = 8192
    history = b""
    first = ""
    for _ in range(updates):
        own = state + 64 >> 7
        neighbours = numbers.array(-127, 127, 4 * channels)
        activation = np.concatenate([own, neighbours])
        for weights, biases in layers[:2]:
            activation = np.clip(weights @ activation + biases + 32 >> 6, 0, 127)
        weights, biases = layers[2]
        state = np.clip(state + weights @ activation + biases, -16256, 16256)
        first = first or " ".join(map(str, state))
        history += state.astype("<i2").tobytes()
    return first, crc(history)


def network_cases() -> list[tuple[str, tuple[int, ...]]]:
    """(name, arguments of run_network) of every case."""
    return [
        ("one channel, one of each", (1, 1, 1, 1, 127, 200)),
        ("shipped widths, small weights", (21, 40, 40, 2, 12, 300)),
        ("shipped widths, any weights", (21, 40, 40, 3, 127, 300)),
        ("widths that no slice divides", (3, 9, 7, 4, 60, 300)),
        ("greatest widths", (51, 127, 127, 5, 127, 60)),
    ]


def text_of_files() -> dict[str, str]:
    """Every file by its name."""
    frames = [
        f'CASE("{name}", {channels}, "{line.hex()}", "{";".join(events)}")'
        for name, channels, line, events in frame_cases()
    ]
    settings = [f'CASE("{name}", "{block.hex()}", "{meaning}")' for name, block, meaning in settings_cases()]
    sentences = [f'CASE("{name}", "{framed(text)}")' for name, text in sentence_cases()]
    commands = [
        f'CASE("{name}", "{line.hex()}", "{";".join(events)}")' for name, line, events in command_cases()
    ]
    networks = []
    for name, (channels, hidden1, hidden2, seed, reach, updates) in network_cases():
        first, check = run_network(channels, hidden1, hidden2, seed, reach, updates)
        size = f"{channels}, {hidden1}, {hidden2}, {seed}, {reach}, {updates}"
        networks.append(f'CASE("{name}", {size}, "{first}", 0x{check:04X})')
    files = {
        "frames": frames,
        "settings": settings,
        "sentences": sentences,
        "commands": commands,
        "networks": networks,
    }
    return {f"{name}.inc": HEADER + "\n".join(cases) + "\n" for name, cases in files.items()}


if __name__ == "__main__":
    for name, text in text_of_files().items():
        (HERE / name).write_text(text, encoding="utf-8")
