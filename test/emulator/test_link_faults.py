"""What happens to arrays: clocks that drift, tiles that come and go, cables that fail, threads."""

from itertools import pairwise

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, NORTH, SOUTH, WEST
from tilenca.emulator import EmulatedTile, LinkFault

# Sends a byte a millisecond to the east, counting up, and keeps what comes from the west.
TALKER = """
static volatile uint8_t heard[256];
static volatile uint16_t count, wrong;
ISR(USART3_RX_vect) { wrong += UCSR3A >> 4 & 1; heard[(uint8_t)count++] = UDR3; }
int main(void) {
    UBRR1 = UBRR3 = 16; UCSR1A = UCSR3A = 2; UCSR1B = 8; UCSR3B = 0x90;
    sei();
    for (uint8_t n = 0;; n++) { _delay_us(990); UDR1 = n; }
}
"""


def pair(elf: object, **options: object) -> Array:
    return Array(str(elf), 2, [(0, EAST, 1, WEST)], **options)


def heard(tile: EmulatedTile) -> list[int]:
    """What came, in order; up to 256 bytes."""
    return list(tile.variable("heard")[: tile.integer("count")])


def everything(array: Array) -> list[object]:
    return [(tile.cycles, tile.pc, tile.read_memory(0, 0x2200)) for tile in array]


# --- links ---


def test_a_byte_on_its_way_is_late_by_the_delay(avr: Compile) -> None:
    elf = avr(TALKER)
    arrival = []
    for delay_s in (0.0, 0.0005):
        array = pair(elf)
        array.set_fault(0, EAST, LinkFault(delay_s=delay_s))
        tap = array[1].probe("J", 0)
        array.run(0.01)
        arrival.append(tap.read()[0].time_s)
        assert heard(array[1]) == list(range(9))
    assert arrival[1] - arrival[0] == pytest.approx(0.0005, abs=1e-7)


def test_lost_bytes_are_missing_and_all_others_whole(avr: Compile) -> None:
    array = pair(avr(TALKER))
    array.set_fault(0, EAST, LinkFault(loss=0.2), seed=3)
    array.run(0.2005)
    counts, came = array.fault_counts(0, EAST), heard(array[1])
    assert counts.bytes in range(200, 204)
    assert 20 <= counts.lost <= 60
    assert len(came) == counts.bytes - counts.lost
    assert all(a < b for a, b in pairwise(came))
    assert array[1].integer("wrong") == 0


def test_flipped_bits_are_as_many_as_were_counted(avr: Compile) -> None:
    array = pair(avr(TALKER))
    array.set_fault(0, EAST, LinkFault(flip=0.05), seed=5)
    array.run(0.2005)
    counts, came = array.fault_counts(0, EAST), heard(array[1])
    differences = [value ^ number for number, value in enumerate(came)]
    assert len(came) == counts.bytes  # none is lost, and framing holds
    assert sum(bin(difference).count("1") for difference in differences) == counts.flipped
    assert 40 <= counts.flipped <= 120
    assert array[1].integer("wrong") == 0


def test_one_direction_fails_alone(avr: Compile) -> None:
    array = Array(avr(TALKER), 2, [(0, EAST, 1, WEST), (1, EAST, 0, WEST)])
    array.set_fault(0, EAST, LinkFault(loss=1.0))
    array.run(0.05)
    assert heard(array[1]) == []
    assert len(heard(array[0])) >= 48


def test_a_software_line_is_spoilt_at_the_rate_of_the_other_end(avr: Compile) -> None:
    # The south side is no USART: here a program toggles PK7 by hand; the northern neighbour has USART 2.
    source = """
    static volatile uint8_t heard[256];
    static volatile uint16_t count;
    ISR(USART2_RX_vect) { heard[(uint8_t)count++] = UDR2; }
    static void put(uint8_t c) {
        uint16_t bits = 0x600 | c << 1;                     /* and a bit of rest between two bytes */
        for (uint8_t i = 0; i < 11; i++, bits >>= 1) {
            if (bits & 1) PORTK |= 0x80; else PORTK &= 0x7F;
            _delay_us(26);
        }
    }
    int main(void) {
        PORTK = 0x80; DDRK = 0x80; UBRR2 = 51; UCSR2A = 2; UCSR2B = 0x90; sei();
        for (uint8_t n = 0; n < 100; n++) put(n);
        for (;;) { }
    }"""
    array = Array(avr(source), 2, [(0, SOUTH, 1, NORTH)])
    array.set_fault(0, SOUTH, LinkFault(loss=0.3), seed=1)
    array.run(0.05)
    counts = array.fault_counts(0, SOUTH)
    assert counts.bytes == 100
    assert len(heard(array[1])) == 100 - counts.lost
    assert 15 <= counts.lost <= 45


@pytest.mark.parametrize(
    "fault", [LinkFault(loss=1.5), LinkFault(flip=-0.1), LinkFault(delay_s=2.0), LinkFault(baud=-1.0)]
)
def test_faults_out_of_range_are_refused(avr: Compile, fault: LinkFault) -> None:
    with pytest.raises(UsageError, match="loss and flip are 0 to 1"):
        pair(avr(TALKER)).set_fault(0, EAST, fault)


# --- cables and tiles while they run ---


def test_a_cut_cable_is_silent_until_it_is_mended(avr: Compile) -> None:
    array = pair(avr(TALKER))
    array.run(0.0205)
    before = len(heard(array[1]))
    array.cut(0, EAST)
    array.run(0.020)
    assert len(heard(array[1])) <= before + 1
    array.mend(1, WEST)
    array.run(0.020)
    came = heard(array[1])
    assert len(came) in (2 * before - 1, 2 * before, 2 * before + 1)
    assert came[-1] - came[before - 2] >= 2 * 19


def test_a_cable_is_taken_away_and_laid_elsewhere(avr: Compile) -> None:
    array = Array(avr(TALKER), 3, [(0, EAST, 1, WEST)])
    array.run(0.010)
    with pytest.raises(UsageError, match="cable already"):
        array.link(0, EAST, 2, WEST)
    array.unlink(1, WEST)
    with pytest.raises(UsageError, match="no cable at side 1 of tile 0"):
        array.cut(0, EAST)
    array.link(0, EAST, 2, WEST)
    array.run(0.010)
    assert len(heard(array[1])) in (8, 9, 10)
    assert len(heard(array[2])) in (9, 10)


def test_a_tile_is_added_and_another_removed_while_they_run(avr: Compile) -> None:
    array = Array(avr(TALKER), 2, [(0, EAST, 1, WEST)])
    array.run(0.010)
    added = array.add_tile(ppm=100)
    array.link(1, EAST, added.index, WEST)
    array.run(0.010)
    assert len(heard(added)) in (8, 9, 10)
    array.remove_tile(1)
    array.run(0.010)
    assert len(heard(added)) in (8, 9, 10, 11)
    assert not array[1].powered
    assert len(array) == 3
    assert added.cycles[0] == pytest.approx(320_000, abs=2000)


def test_a_neighbour_without_power_says_nothing_and_starts_anew(avr: Compile) -> None:
    array = pair(avr(TALKER))
    array.run(0.0101)
    array[0].powered = False
    array.run(0.010)
    before = len(heard(array[1]))
    array.run(0.010)
    assert len(heard(array[1])) == before
    array[0].powered = True
    array.run(0.010)
    assert heard(array[1])[before:] == list(range(9))


# --- clocks ---


def test_a_drifting_clock_gains_with_the_square_of_time(avr: Compile) -> None:
    array = Array(avr("int main(void) { for (;;) { } }"), 2)
    array[1].set_drift(100.0)
    array.run(2.0)
    gained = array[1].cycles[0] - array[0].cycles[0]
    # Half of 100 ppm/s times (2 s)^2 is 200 us; the rate grows in steps of 65.5 ms, half a step late.
    assert gained == pytest.approx(16 * (200 - 2 * 100 * 0.0655 / 2), abs=20)


@pytest.mark.parametrize(("ppm_per_s", "rate"), [(-1e6, 0.5), (1e6, 1.5)])
def test_a_clock_drifts_no_further_than_a_clock_can_be_wrong(
    ppm_per_s: float, rate: float, avr: Compile
) -> None:
    array = Array(avr("int main(void) { for (;;) { } }"))
    array[0].set_drift(ppm_per_s)
    array.run(1.5)  # without an end it would have stood still, or run backwards
    before, (cycles, *_) = array.save(), array[0].cycles
    array.run(0.5)
    assert array[0].cycles[0] - cycles == pytest.approx(8e6 * rate, abs=200)
    array.restore(before)


def test_drift_does_not_depend_on_how_time_is_sliced(avr: Compile) -> None:
    elf = avr(TALKER)
    arrays = [pair(elf, ppm=[500, -500]) for _ in range(2)]
    for array, slices in zip(arrays, (1, 97), strict=True):
        array[0].set_drift(1000.0)
        array[1].set_drift(-3000.0)
        for _ in range(slices):
            array.run(0.3 / slices)
    assert everything(arrays[0]) == everything(arrays[1])


def test_a_skewed_clock_is_faster_by_so_much_until_it_is_not(avr: Compile) -> None:
    array = Array(avr("int main(void) { for (;;) { } }"), 2, ppm=[0, 300])
    array.run(0.5)
    array[1].set_skew(20_000.0)
    array.run(0.5)
    skewed = array.save()
    array[1].set_skew(0.0)
    array.run(0.5)
    ahead = array[1].cycles[0] - array[0].cycles[0]
    assert ahead == pytest.approx(16e6 * (1.5 * 300e-6 + 0.5 * 20_000e-6), abs=20)
    array.restore(skewed)  # a snapshot knows it
    array.run(0.5)
    ahead = array[1].cycles[0] - array[0].cycles[0]
    assert ahead == pytest.approx(16e6 * (1.5 * 300e-6 + 20_000e-6), abs=20)


# --- threads ---


def spoilt(elf: object, threads: int) -> Array:
    links = [(tile, EAST, tile + 1, WEST) for tile in range(6)]
    ppm = [300.0 * tile - 900 for tile in range(7)]
    array = Array(str(elf), 7, links, ppm, [0.001 * tile for tile in range(7)], threads=threads)
    for tile in range(6):
        array.set_fault(tile, EAST, LinkFault(loss=0.1, flip=0.01, delay_s=0.0001 * tile), seed=tile)
    array[3].set_drift(50.0)
    return array


@pytest.mark.parametrize("threads", [2, 3, 8])
def test_threads_change_no_byte(avr: Compile, threads: int) -> None:
    elf = avr(TALKER)
    one, many = spoilt(elf, 1), spoilt(elf, threads)
    for array in (one, many):
        array.run(0.05)
        array.cut(2, EAST)
        array[4].powered = False
        array.run(0.02)
        array[4].powered = True
        array.mend(2, EAST)
        array.run(0.05)
    assert everything(one) == everything(many)
    assert one.save() == many.save()
    assert sum(len(heard(tile)) for tile in one) > 400


@pytest.mark.parametrize("threads", [2, 3])
def test_a_breakpoint_ends_all_tiles_in_the_same_turn_on_any_number_of_threads(
    avr: Compile, threads: int
) -> None:
    elf = avr(TALKER)
    one, many = spoilt(elf, 1), spoilt(elf, threads)
    for array in (one, many):
        array.run(0.013)
        array[5].set_breakpoint("main")
        array[5].reset()
        array.run(0.05)
        assert array[5].halted
    assert 0.013 < one.time_s < 0.063
    assert many.time_s == one.time_s
    assert many.save() == one.save()


def test_a_hundred_tiles_run(avr: Compile) -> None:
    side = 10
    links = [(n, EAST, n + 1, WEST) for n in range(side * side) if n % side != side - 1]
    links += [(n, SOUTH, n + side, NORTH) for n in range(side * (side - 1))]
    array = Array(avr(TALKER), side * side, links, threads=2)
    array.run(0.02)
    assert all(len(heard(tile)) in (18, 19, 20) for tile in array if tile.index % side)
    assert words(array[0].variable("count")) == [0]
