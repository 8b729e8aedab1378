"""What can be seen of pins: wires, edges, waveforms."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

from support.avr import Compile
from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, SOUTH, WEST
from tilenca.emulator import Array, Waveforms

TALKER = """
static void put(uint8_t c) { while (!(UCSR1A & 0x20)) { } UDR1 = c; }
int main(void) {
    UBRR1 = 51; UCSR1A = 2; UCSR1B = 8;                     /* 38,400 baud, to the east */
    for (uint8_t n = 1;; n++) { put(n); put(n ^ 0xFF); put(0); _delay_ms(1); }
}
"""


@pytest.mark.parametrize("delay_us", [20, 68, 260])
def test_a_tap_reads_the_bytes_of_a_wire_after_the_cables_delay(avr: Compile, delay_us: int) -> None:
    array = Array(avr(TALKER), 2, [(0, EAST, 1, WEST)], cable_delay_s=delay_us / 1e6)
    sent, arrived = array[0].tap(EAST), array[1].tap(WEST, baud=38400, receiving=True)
    array.run(0.0115)
    bytes_sent, bytes_arrived = sent.read(), arrived.read()
    assert [byte.value for byte in bytes_sent[:6]] == [1, 254, 0, 2, 253, 0]
    assert not any(byte.framing_error for byte in bytes_sent)
    assert [byte.value for byte in bytes_arrived] == [byte.value for byte in bytes_sent]
    late = {round((b.time_s - a.time_s) * 1e6) for a, b in zip(bytes_sent, bytes_arrived, strict=True)}
    assert late == {delay_us}
    array.run(0.01)
    assert sent.read()[0].time_s > bytes_sent[-1].time_s


def test_a_tap_gives_whole_frames(avr: Compile) -> None:
    array = Array(avr(TALKER))
    tap = array[0].tap(EAST)
    frames = []
    for _ in range(20):
        array.run(0.0007)
        frames += [frame.data for frame in tap.read_frames()]
    assert frames == [bytes([n, n ^ 0xFF]) for n in range(1, len(frames) + 1)]
    assert len(frames) in (10, 11)  # 1.27 ms each
    tap.close()
    array.run(0.01)
    assert tap.read() == []


def test_a_tap_on_a_line_without_usart_reads_at_the_rate_given(avr: Compile) -> None:
    source = """
    static void put(uint8_t c) {
        for (uint16_t bits = 0x600 | c << 1, i = 0; i < 11; i++, bits >>= 1) {
            if (bits & 1) PORTK |= 0x80; else PORTK &= 0x7F;
            _delay_us(103.5);
        }
    }
    int main(void) {
        PORTK = 0x80; DDRK = 0x80;
        for (const char *c = "south"; *c; c++) put(*c);
        for (;;) { }
    }"""
    array = Array(avr(source))
    tap = array[0].tap(SOUTH, baud=9600)
    array.run(0.01)
    assert bytes(byte.value for byte in tap.read()) == b"south"


PINS = """
int main(void) {
    DDRB = 0x20; DDRK = 0x01;
    for (uint8_t i = 0; i < 5; i++) { PINB = 0x20; _delay_us(10); if (PINK & 0x40) PINK = 1; }
    for (;;) { }
}
"""


def test_a_probe_keeps_every_edge_with_its_cycle(avr: Compile) -> None:
    array = Array(avr(PINS))
    probe, other = array[0].probe("B", 5), array[0].probe("K", 6)
    array[0].push_edge("K", 6, 700, False)
    assert probe.level is True  # as long as nobody drives it
    array.run(0.001)
    start, *edges = probe.read()
    assert start.level is False
    assert [edge.level for edge in edges] == [True, False, True, False, True]
    periods = {round((b.time_s - a.time_s) * 16e6) for a, b in pairwise(edges)}
    assert all(165 <= period <= 180 for period in periods)
    assert [(round(edge.time_s * 16e6), edge.level) for edge in other.read()] == [(700, False)]
    assert probe.read() == []
    assert probe.level is True
    with pytest.raises(UsageError, match="no pin PI3"):
        array[0].probe("I", 3)


def test_waveforms_are_a_value_change_dump(avr: Compile, tmp_path: Path) -> None:
    array = Array(avr(PINS), 2, ppm=[0, 1000])
    waves = Waveforms([array[0].probe("B", 5), array[1].probe("B", 5), array[1].probe("K", 0)])
    array.run(0.0001)
    waves.collect()
    array.run(0.001)
    path = tmp_path / "waves.vcd"
    waves.write(path)
    text = path.read_text()
    assert text.startswith("$timescale 100 ps $end\n$scope module tile1 $end\n$var wire 1 ! PB5 $end\n")
    assert text.count("$scope") == text.count("$upscope") == 2
    assert '$enddefinitions $end\n#0\n$dumpvars\n1!\n1"\n1#\n$end\n' in text
    times = [int(stamp) for stamp in re.findall(r"^#(\d+)$", text, re.MULTILINE)]
    assert times == sorted(times)
    assert len(re.findall(r"^[01]!$", text, re.MULTILINE)) == 1 + 1 + 5
    changes = re.findall(r"^#(\d+)\n(?:[01]\"\n|[01]#\n)*([01])!", text, re.MULTILINE)
    assert all(625 * 165 <= int(b[0]) - int(a[0]) <= 625 * 180 for a, b in pairwise(changes[2:]))
