"""What can be seen of a tile: variables, stack, sleep, marks."""

import pytest

from support.avr import Compile
from tilenca.base.errors import UsageError
from tilenca.emulator import Array

VARIABLES = """
volatile uint8_t byte = 7;
volatile int16_t word = -2;
volatile uint32_t array[3] = {1, 0x12345678, 3};
static volatile uint8_t hidden = 9;
const uint8_t in_flash[] PROGMEM = {1};
__attribute__((noinline)) uint8_t deep(uint8_t n) {
    volatile uint8_t frame[50];
    frame[n % 50] = n;
    return n == 0 ? frame[0] : deep(n - 1) + frame[n % 50];
}
int main(void) { byte = pgm_read_byte(in_flash); byte = 77; hidden = 10; deep(DEPTH); for (;;) { } }
"""


def test_variables_are_read_by_their_names(avr: Compile) -> None:
    array = Array(avr(VARIABLES, "-DDEPTH=1", "-Wno-unused"))
    array.run(0.001)
    tile = array[0]
    assert (tile.integer("byte"), tile.integer("word", signed=True), tile.integer("hidden")) == (77, -2, 10)
    assert tile.variable("array") == bytes([1, 0, 0, 0, 0x78, 0x56, 0x34, 0x12, 3, 0, 0, 0])
    with pytest.raises(UsageError, match="no symbol 'nowhere'"):
        tile.variable("nowhere")
    with pytest.raises(UsageError, match="'main' is no variable in SRAM"):
        tile.variable("main")
    with pytest.raises(UsageError, match="'byte' is no function"):
        tile.mark("byte")


def test_the_stack_s_high_water_mark_is_exact(avr: Compile) -> None:
    deepest = []
    for depth in (1, 2, 11):
        array = Array(avr(VARIABLES, f"-DDEPTH={depth}", "-Wno-unused"))
        array.run(0.01)
        deepest.append(array[0].stack.most_bytes)
        assert array[0].stack.floor == 0x200 + 1 + 2 + 12 + 1
    frame = deepest[1] - deepest[0]
    assert frame in range(50 + 3, 50 + 3 + 8)
    assert deepest[2] - deepest[0] == 10 * frame


def test_the_share_of_sleep_is_told(avr: Compile) -> None:
    source = """
    ISR(TIMER1_COMPA_vect) { }
    int main(void) {
        OCR1A = 15999; TCCR1B = 9; TIMSK1 = 2; set_sleep_mode(SLEEP_MODE_IDLE); sei();
        for (;;) { sleep_mode(); _delay_us(250); }
    }"""
    array = Array(avr(source))
    array.run(1.0)
    assert array[0].sleep_share == pytest.approx(0.75, abs=0.01)


MARKED = """
volatile uint8_t sink;
__attribute__((noinline)) void begin(void) { sink = 1; }
__attribute__((noinline)) void finish(void) { sink = 2; }
int main(void) { for (;;) { begin(); _delay_us(100); finish(); _delay_us(300); } }
"""


def test_cycles_between_two_marks(avr: Compile) -> None:
    elf = avr(MARKED)
    array = Array(elf, 2)
    array[1].mark("begin")
    array[1].mark("finish")
    array.run(0.01)
    marks = array[1].marks()
    assert [mark.function for mark in marks[:4]] == ["begin", "finish", "begin", "finish"]
    assert {b.cycle - a.cycle for a, b in zip(marks[::2], marks[1::2], strict=False)} == {8 + 1600 + 5}
    assert array[0].marks() == []
    assert array[0].cycles == array[1].cycles  # looking costs no time
    array[1].mark("begin", False)
    array.run(0.01)
    assert {mark.function for mark in array[1].marks()} == {"finish"}
