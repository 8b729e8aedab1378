"""Saving whole arrays, going back, and the same future again."""

import random
from pathlib import Path

import pytest

from support.avr import Compile
from tilenca.base.errors import UsageError
from tilenca.base.sides import EAST, WEST
from tilenca.emulator import Array, LinkFault
from tilenca.emulator.history import History

# Everything that holds state is in use: timers, USARTs, EEPROM, ADC, SPI, TWI, the watchdog, sleep, the heap.
BUSY = """
#include <stdlib.h>
static volatile uint16_t ticks, bytes, conversions;
static volatile uint32_t sum;
ISR(TIMER1_COMPA_vect) { ticks++; UDR1 = ticks; }
ISR(TIMER3_CAPT_vect) { sum += ICR3; }
ISR(USART3_RX_vect) { bytes++; sum = sum * 31 + UDR3; }
ISR(ADC_vect) { conversions++; sum += ADC; }
ISR(WDT_vect) { sum ^= 0x55; }
ISR(PCINT2_vect) { sum += 3; }
int main(void) {
    uint8_t *block = malloc(100);
    UBRR1 = UBRR3 = 16; UCSR1A = UCSR3A = 2; UCSR1B = 8; UCSR3B = 0x90;
    UBRR0 = 16; UCSR0A = 2; UCSR0B = 0x18;
    OCR1A = 7999; TCCR1B = 9; TIMSK1 = 2;
    DDRB = 0x77; TCCR2A = 0x83; OCR2A = 77; TCCR2B = 2;
    TCCR3B = 1; TIMSK3 = 0x20; TCCR4A = 0x81; OCR4A = 100; TCCR4B = 0x11; DDRH = 0x08;
    ADMUX = 0x40; ADCSRA = 0xEF;
    SPCR = 0x53; SPDR = 0x3C; TWBR = 72; TWCR = 0xA4;
    PCMSK2 = 0x80; PCICR = 4;
    cli(); WDTCSR = 0x18; WDTCSR = 0x40; sei();
    set_sleep_mode(SLEEP_MODE_IDLE);
    for (uint16_t n = 0;; n++) {
        if (n % 4 == 0) eeprom_update_byte((uint8_t *)(n & 0xFF), n);
        if (SPSR & 0x80) SPDR = n;
        if (TWCR & 0x80) TWCR = 0x94;
        block[n % 100] += n;
        if (UCSR0A & 0x20) UDR0 = sum;
        if (n % 8 == 0) sleep_mode();
    }
}
"""


def build(elf: object, threads: int = 1) -> Array:
    array = Array(
        str(elf), 3, [(0, EAST, 1, WEST), (1, EAST, 2, WEST)], [400, -400, 0], [0, 0.001, 0.002],
        threads=threads,
    )  # fmt: skip
    array.set_fault(0, EAST, LinkFault(loss=0.1, flip=0.02), seed=9)
    array[1].set_adc_noise(2.0, seed=4)
    array[2].set_drift(200.0)
    for tile in array:
        tile.set_analog(0, 300 + tile.index)
    return array


def everything(array: Array) -> list[object]:
    return [
        (
            tile.cycles,
            tile.pc,
            tile.read_memory(0, 0x2200),
            tile.read_eeprom(),
            tile.stack,
            tile.read_serial(),
        )
        for tile in array
    ]


def test_a_restored_array_has_the_same_future(avr: Compile) -> None:
    array = build(avr(BUSY))
    array.run(0.0512)
    array[0].write_serial(b"on its way")
    array[1].hold_pin("K", 7, False)
    snapshot = array.save()
    array.run(0.05)
    future, saved = everything(array), array.save()
    array.restore(snapshot)
    assert array.time_s == pytest.approx(0.0512, abs=16e-6)
    array.run(0.05)
    assert everything(array) == future
    assert array.save() == saved


def test_it_is_restored_in_another_array_on_other_threads(avr: Compile) -> None:
    elf = avr(BUSY)
    array = build(elf)
    array.run(0.03)
    snapshot = array.save()
    array.run(0.03)
    other = Array(elf, threads=2)  # one tile, no cables
    other.restore(snapshot)
    assert len(other) == 3
    other.run(0.03)
    assert everything(other) == everything(array)


def test_what_was_added_cut_and_switched_off_since_is_as_before(avr: Compile) -> None:
    array = build(avr(BUSY))
    array.run(0.02)
    snapshot = array.save()
    array.run(0.02)
    future = everything(array)
    array.restore(snapshot)
    array.add_tile()
    array.cut(0, EAST)
    array.remove_tile(2)
    array.run(0.02)
    array.restore(snapshot)
    assert len(array) == 3
    array.run(0.02)
    assert everything(array) == future


PROGRAMMER = """
#include <avr/boot.h>
BOOTLOADER_SECTION __attribute__((noinline)) void fill(uint8_t n) {
    boot_page_erase(0x8000); boot_spm_busy_wait();
    boot_page_fill(0x8000, 0x1100 + n); boot_page_write(0x8000); boot_spm_busy_wait(); boot_rww_enable();
}
int main(void) { for (uint8_t n = 0;; n++) { fill(n); result[0] = pgm_read_byte(0x8000); } }
"""


def test_flash_that_a_tile_has_written_is_its_own_and_part_of_the_snapshot(avr: Compile) -> None:
    array = Array(avr(PROGRAMMER, "-Wl,--section-start=.bootloader=0x3E000"), 2, switch_on_s=[0, 1])
    fresh = array.save()
    array.run(0.0300)
    snapshot, flash = array.save(), array[0].read_flash(0x8000, 4)
    array.run(0.02)
    assert array[0].read_flash(0x8000, 4) != flash
    assert array[1].read_flash(0x8000, 4) == b"\xff" * 4
    array.restore(snapshot)
    assert array[0].read_flash(0x8000, 4) == flash
    array.restore(fresh)
    assert array[0].read_flash(0x8000, 4) == b"\xff" * 4


def test_damaged_snapshots_are_refused_in_one_line(avr: Compile, tmp_path: Path) -> None:
    array = build(avr(BUSY))
    array.run(0.005)
    good = array.save()
    draw = random.Random(11)
    for _ in range(150):
        damaged = bytearray(good[: draw.randrange(len(good))] if draw.random() < 0.4 else good)
        for _ in range(draw.randrange(1, 4)):
            if damaged:
                damaged[draw.randrange(len(damaged))] ^= draw.randrange(1, 256)
        with pytest.raises(UsageError, match=r"^snapshot: [^\n]*; save it anew$"):
            array.restore(bytes(damaged))
    array.restore(good)
    with pytest.raises(UsageError, match="another image"):
        Array(avr("int main(void) { for (;;) { } }")).restore(good)


def test_stepping_back_in_time(avr: Compile) -> None:
    array = build(avr(BUSY))
    history = History(array, every_s=0.01)
    history.run(0.1)
    end = array.save()
    history.go_to(0.0432)
    assert array.time_s == pytest.approx(0.0432, abs=16e-6)
    history.go_to(0.0999)
    history.run(0.0001)
    assert array.time_s == pytest.approx(0.1, abs=32e-6)
    history.go_to(0.0)
    assert [tile.cycles[0] for tile in array] == [0, 0, 0]
    array.run(0.1)
    assert array.save() == end


def test_a_history_keeps_no_more_than_it_was_told(avr: Compile) -> None:
    array = build(avr(BUSY))
    history = History(array, every_s=0.001, most=10)
    history.run(0.1)
    assert len(history.moments_s) == 10
    with pytest.raises(UsageError, match=r"the oldest moment kept is 0\.09"):
        history.go_to(0.05)
