"""Every frame format of the USARTs, from one tile to another, and what happens when the two differ."""

import pytest

from support.avr import Compile, words
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array

# Tile 0 sends eight words to tile 1; each has its own format.
SPEAKER = """
#define SIZE(bits) ((bits) == 9 ? 3 : (bits) - 5)
static void format(volatile uint8_t *b, volatile uint8_t *c, uint8_t bits, uint8_t parity, uint8_t stop) {
    *c = parity << 4 | (stop - 1) << 3 | SIZE(bits) << 1;
    if (bits == 9) *b |= 4;
}
static const uint16_t said[8] = {0x000, 0x1FF, 0x155, 0x0AA, 0x101, 0x0F0, 0x01C, 0x1E3};
int main(void) {
    UBRR1 = UBRR3 = 51; UCSR1A = UCSR3A = 2;
    UCSR1B = 8; UCSR3B = 0x10;
    uint8_t first = eeprom_read_byte(0);
    if (first) {
        format(&UCSR1B, &UCSR1C, SENDER);
        _delay_ms(1);
        for (uint8_t i = 0; i < 8; i++) {
            while (!(UCSR1A & 0x20)) { }
            if (said[i] & 0x100) UCSR1B |= 1; else UCSR1B &= ~1;
            UDR1 = said[i];
        }
    } else {
        format(&UCSR3B, &UCSR3C, RECEIVER);
        for (uint8_t i = 0; i < 8;) {
            if (!(UCSR3A & 0x80)) continue;
            result[32 + i] = UCSR3A & 0x1C;
            uint16_t high = UCSR3B >> 1 & 1;
            result16[i++] = UDR3 | high << 8;
            result[63] = i;
        }
    }
    for (;;) { }
}
"""
SAID = [0x000, 0x1FF, 0x155, 0x0AA, 0x101, 0x0F0, 0x01C, 0x1E3]
NONE, EVEN, ODD = 0, 2, 3
FE, DOR, UPE = 0x10, 0x08, 0x04


def spoken(avr: Compile, sender: tuple[int, int, int], receiver: tuple[int, int, int]) -> Array:
    def listed(form: tuple[int, int, int]) -> str:
        return ",".join(map(str, form))

    elf = avr(SPEAKER, f"-DSENDER={listed(sender)}", f"-DRECEIVER={listed(receiver)}")
    array = Array(elf, 2, [(0, EAST, 1, WEST)], ppm=[4000, -4000])
    array[0].write_eeprom(0, b"\x01")
    array[1].write_eeprom(0, b"\x00")
    array.run(0.01)
    return array


@pytest.mark.parametrize("bits", [5, 6, 7, 8, 9])
@pytest.mark.parametrize("parity", [NONE, EVEN, ODD])
@pytest.mark.parametrize("stop", [1, 2])
def test_every_format_arrives_whole(avr: Compile, bits: int, parity: int, stop: int) -> None:
    tile = spoken(avr, (bits, parity, stop), (bits, parity, stop))[1]
    memory = tile.read_memory(0x1000, 64)
    assert words(memory[:16]) == [word & (1 << bits) - 1 for word in SAID]
    assert memory[32:40] == bytes(8)
    assert memory[63] == 8


@pytest.mark.parametrize("bits", [5, 8])
def test_a_frame_takes_as_long_as_its_bits(avr: Compile, bits: int) -> None:
    for parity in (NONE, EVEN):
        for stop in (1, 2):
            elf = avr(SPEAKER, f"-DSENDER={bits},{parity},{stop}", "-DRECEIVER=8,0,1")
            array = Array(elf)
            array[0].write_eeprom(0, b"\x01")
            probe = array[0].probe("D", 3)
            array.run(0.01)
            falls = [edge.time_s for edge in probe.read() if not edge.level]
            frame = 1 + bits + (parity != NONE) + stop
            # The first word is all zeros: its frame begins with a fall, and so does the second one's.
            second = next(time for time in falls[1:] if time - falls[0] > (frame - 1.5) * 52 * 8 / 16e6)
            assert (second - falls[0]) * 16e6 == pytest.approx(frame * 52 * 8, abs=1e-3)


def test_the_other_parity_is_an_error_of_every_word(avr: Compile) -> None:
    memory = spoken(avr, (8, EVEN, 1), (8, ODD, 1))[1].read_memory(0x1000, 64)
    assert words(memory[:16]) == [word & 0xFF for word in SAID]
    assert memory[32:40] == bytes([UPE]) * 8


def test_a_longer_frame_has_no_stop_bit_where_it_should_be(avr: Compile) -> None:
    memory = spoken(avr, (9, NONE, 2), (8, NONE, 1))[1].read_memory(0x1000, 64)
    expected = [0 if word & 0x100 else FE for word in SAID]
    assert words(memory[:16]) == [word & 0xFF for word in SAID]
    assert list(memory[32:40]) == expected


def test_a_shorter_frame_is_filled_with_its_stop_bits(avr: Compile) -> None:
    memory = spoken(avr, (7, NONE, 2), (8, NONE, 1))[1].read_memory(0x1000, 64)
    assert words(memory[:16]) == [word & 0x7F | 0x80 for word in SAID]
    assert memory[32:40] == bytes(8)
