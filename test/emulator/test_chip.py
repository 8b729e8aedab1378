"""EEPROM, ADC, self-made faults, and what is not modelled."""

import pytest

from support.avr import Compile, words
from support.avr import IdealArray as Array
from tilenca.base.errors import TilencaError


def test_an_eeprom_write_takes_its_time_and_lasts(avr: Compile) -> None:
    source = """
    int main(void) {
        TCCR5B = 3;                                          /* 4 us */
        uint8_t before = eeprom_read_byte((uint8_t *)4095);
        TCNT5 = 0;
        eeprom_write_byte((uint8_t *)4095, 0x5A);
        while (EECR & 2) { }
        result16[0] = TCNT5;
        result[2] = before;
        result[3] = eeprom_read_byte((uint8_t *)4095);
        EEAR = 7; EEDR = 1; EECR = 2;                        /* without EEMPE: nothing happens */
        result[4] = EECR;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array[0].write_eeprom(4095, b"\x11")
    array.run(0.01)
    memory = array[0].read_memory(0x1000, 5)
    assert words(memory[:2])[0] * 4 == pytest.approx(3400, abs=8)
    assert memory[2:] == bytes([0x11, 0x5A, 0])
    assert array[0].read_eeprom(4095, 1) == b"\x5a"
    assert array[0].read_eeprom(7, 1) == b"\xff"


def test_a_reset_while_the_eeprom_writes_loses_nothing(avr: Compile) -> None:
    array = Array(
        avr("int main(void) { if (eeprom_read_byte(0) == 0xFF) eeprom_write_byte(0, 3); for (;;) { } }")
    )
    array.run(0.001)
    array[0].reset()
    array.run(0.01)
    assert array[0].read_eeprom(0, 1) == b"\x03"


def test_the_adc_converts_every_channel_in_its_time(avr: Compile) -> None:
    source = """
    int main(void) {
        TCCR5B = 1; TCNT5 = 0; ADCSRA = 0x87;               /* the prescaler starts here */
        for (uint8_t channel = 0; channel < 16; channel++) {
            ADMUX = 0x40 | (channel & 7); ADCSRB = channel & 8;
            uint16_t from = TCNT5;
            ADCSRA |= 0x40;
            while (ADCSRA & 0x40) { }
            uint16_t to = TCNT5;
            result16[channel] = ADC;
            if (channel < 8) { result16[16 + 2 * channel] = from; result16[17 + 2 * channel] = to; }
        }
        for (;;) { }
    }"""
    array = Array(avr(source))
    for channel in range(16):
        array[0].set_analog(channel, 60 * channel + 7)
    array.run(0.01)
    memory = words(array[0].read_memory(0x1000, 64))
    assert memory[:16] == [60 * channel + 7 for channel in range(16)]
    for number, (start, end) in enumerate(zip(memory[16::2], memory[17::2], strict=True)):
        # It begins with the next of the prescaler's edges after the program has asked.
        edge = -(-start // 128) * 128
        assert end == pytest.approx(edge + (25 if number == 0 else 13) * 128, abs=16)


@pytest.mark.parametrize(
    ("source", "fact"),
    [
        ('asm volatile(".word 0xFF0F");', "in main: illegal instruction"),
        ('asm volatile("jmp 0x20000");', "ran into erased flash"),
        (
            'asm volatile("ldi r30, 0\\n out 0x3C, r30\\n ldi r31, 0x80\\n ijmp" ::: "r30", "r31");',
            "ran into erased",
        ),
        ('asm volatile(".word 0x941c, 0x0000");', "ran off the end of flash"),  # jmp 0x40000
    ],
)
def test_a_program_that_leaves_the_road_stops_with_tile_place_and_fact(
    avr: Compile, source: str, fact: str
) -> None:
    elf = avr(f"int main(void) {{ {source} for (;;) {{ }} }}")
    array = Array(elf, tiles=2, switch_on_s=[0.5, 0.0])
    with pytest.raises(TilencaError, match=r"tile 2 stopped at 0x[0-9A-F]{5}.*" + fact):
        array.run(0.1)
    assert not array[0].fault


def test_what_is_not_modelled_warns_once_by_name(avr: Compile) -> None:
    source = """
    int main(void) {
        SPCR = 0; TWBR = 72; ACSR = 0x80; PRR0 = 0; DIDR0 = 255;      /* harmless */
        for (uint8_t i = 0; i < 3; i++) { XMCRA = 0x80; ASSR = 0x20; }
        result[0] = XMCRA; *(volatile uint8_t *)0x3000 = 1;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    assert array[0].warnings == [
        "external memory (XMCRA)",
        "asynchronous clock of timer 2 (ASSR)",
        "write beyond the end of SRAM (first: address 0x3000)",
    ]
    assert array[0].read_memory(0x1000, 1) == b"\x80"


def test_an_external_reset_says_so_and_keeps_sram(avr: Compile) -> None:
    source = """
    int main(void) {
        result[1] = MCUSR; MCUSR = 0;
        if (result[1] & 2) result[2] = result[0]; else result[0] = 99;
        PORTB = 0xFF; DDRB = 0xFF;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 2) == bytes([99, 1])
    array[0].reset()
    assert not array[0].duty("B", 0)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 3) == bytes([99, 2, 99])


@pytest.mark.parametrize(
    ("source", "warning"),
    [
        ("UCSR2C = 0x46;", "USART in synchronous or SPI mode (UMSEL)"),
        ("SPCR = 0x40;", "SPI as slave (SPCR): nobody clocks it"),
        ("TWAR = 0x42;", "TWI as slave (TWAR): nobody addresses it"),
        ("OSCCAL = 0x70;", "oscillator calibration (OSCCAL)"),
        ("OCDR = 1;", "on-chip debug register (OCDR)"),
    ],
)
def test_each_thing_not_modelled_has_its_name(avr: Compile, source: str, warning: str) -> None:
    array = Array(avr(f"int main(void) {{ {source} {source} for (;;) {{ }} }}"))
    array.run(0.001)
    assert array[0].warnings == [warning]


READ_ROWS = """#include <avr/boot.h>
int main(void) {
    result[0] = boot_signature_byte_get(0); result[1] = boot_signature_byte_get(2);
    result[2] = boot_signature_byte_get(4);
    result[3] = boot_lock_fuse_bits_get(GET_LOW_FUSE_BITS);
    result[4] = boot_lock_fuse_bits_get(GET_HIGH_FUSE_BITS);
    result[5] = boot_lock_fuse_bits_get(GET_EXTENDED_FUSE_BITS);
    result[6] = boot_lock_fuse_bits_get(GET_LOCK_BITS);
    result[7] = pgm_read_byte(0);
    for (;;) { }
}
"""


def test_a_program_reads_signature_fuses_and_lock_bits(avr: Compile) -> None:
    array = Array(avr(READ_ROWS))
    first_byte = array[0].read_flash(0, 1)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 8) == bytes([0x1E, 0x98, 0x01, 0xFF, 0xD9, 0xFD, 0xFF]) + first_byte
    array[0].set_fuses(0xEF, 0xD1, 0xFC, 0xFE)
    array.run(0.001)
    assert array[0].read_memory(0x1003, 4) == bytes([0xEF, 0xD1, 0xFC, 0xFE])


def test_fuses_and_lock_bits_in_an_elf_count(avr: Compile) -> None:
    marks = "FUSES = {.low = 0xE0, .high = 0xD3, .extended = 0xFC}; LOCKBITS = 0xCF;\n"
    array = Array(avr("#include <avr/fuse.h>\n#include <avr/lock.h>\n" + marks + READ_ROWS))
    array.run(0.001)
    assert array[0].read_memory(0x1003, 4) == bytes([0xE0, 0xD3, 0xFC, 0xCF])


# What stands in the boot section is at hand as `boot`; it answers through `result`.
BOOT = """
#include <avr/boot.h>
static const uint8_t table[] __attribute__((aligned(256), section(".table"))) = {0x12, 0x34};
#define PAGE 0x8000
BOOTLOADER_SECTION __attribute__((noinline)) void boot(void) { CODE }
int main(void) { boot(); result[15] = 0x77; for (;;) { } }
"""


def in_boot_section(avr: Compile, code: str, start: int = 0x3E000) -> Array:
    places = (f"-Wl,--section-start=.bootloader={start:#x}", "-Wl,--section-start=.table=0x8000")
    array = Array(avr(BOOT.replace("CODE", code), "-Wno-unused", *places))
    array.run(0.02)
    assert array[0].read_memory(0x100F, 1) == b"\x77"
    return array


WRITE_PAGE = """
    boot_page_erase(PAGE); boot_spm_busy_wait();
    result[0] = SPMCSR; result[1] = pgm_read_byte(PAGE + 2); result[2] = pgm_read_byte(0);
    boot_page_fill(PAGE, 0xBEEF); result[3] = SPMCSR;
    boot_page_write(PAGE); boot_spm_busy_wait();
    boot_rww_enable(); result[4] = SPMCSR; result[5] = pgm_read_byte(PAGE);
"""


def test_the_boot_section_writes_a_page_and_reads_nothing_else_meanwhile(avr: Compile) -> None:
    array = in_boot_section(avr, WRITE_PAGE)
    assert array[0].read_memory(0x1000, 6) == bytes([0x40, 0xFF, 0xFF, 0x00, 0x00, 0xEF])
    assert array[0].read_flash(0x8000, 3) == b"\xef\xbe\xff"
    assert array[0].warnings == ["flash read before it was opened again after a page (RWWSRE): reads as 0xFF"]


def test_the_application_cannot_write_flash(avr: Compile) -> None:
    array = in_boot_section(avr, WRITE_PAGE, start=0x3DF00)
    after_erase, _, first_byte = array[0].read_memory(0x1000, 3)
    assert array[0].read_flash(0x8000, 256) == b"\xff" * 256
    assert after_erase == 0
    assert first_byte != 0xFF  # flash stays readable
    assert array[0].warnings == ["SPM outside the boot section (from 0x3E000 on): no effect"]


@pytest.mark.parametrize("command", ["_BV(SPMEN)", "_BV(SPMEN) | _BV(PGERS)", "_BV(SPMEN) | _BV(BLBSET)"])
def test_a_flash_command_that_is_not_carried_out_lapses(avr: Compile, command: str) -> None:
    wait_in_vain = f"""
        SPMCSR = {command}; result[0] = SPMCSR;
        boot_spm_busy_wait();
        result[1] = SPMCSR;
    """
    array = in_boot_section(avr, wait_in_vain + WRITE_PAGE.replace("result[", "result[8 + "))
    armed, lapsed = array[0].read_memory(0x1000, 2)
    assert armed & 1
    assert lapsed == 0
    assert array[0].read_flash(0x8000, 2) == b"\xef\xbe"


def test_lock_bits_that_forbid_a_write_stop_the_tile(avr: Compile) -> None:
    forbidden = "boot_lock_bits_set(_BV(BLB11)); result[6] = 1; boot_page_erase(0x3E000ul);"
    places = ("-Wl,--section-start=.bootloader=0x3E000", "-Wl,--section-start=.table=0x8000")
    array = Array(avr(BOOT.replace("CODE", forbidden), "-Wno-unused", *places))
    with pytest.raises(
        TilencaError,
        match=r"tile 1 stopped at 0x3E0[0-9A-F]{2} in boot: SPM at flash address 0x3E000 in the boot "
        r"section, which lock bits 0xEF forbid",
    ):
        array.run(0.02)
    assert array[0].read_memory(0x1006, 1) == b"\x01"


def test_lock_bits_hide_the_boot_section_from_the_application(avr: Compile) -> None:
    source = """
    BOOTLOADER_SECTION const uint8_t secret[] = {42};
    int main(void) {
        result[0] = pgm_read_byte_far(0x3E000ul); result[1] = pgm_read_byte(0);
        for (;;) { }
    }"""
    array = Array(avr("#include <avr/boot.h>\n" + source, "-Wl,--section-start=.bootloader=0x3E000"))
    first_byte = array[0].read_flash(0, 1)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 2) == b"\x2a" + first_byte
    array[0].set_fuses(lock=0xDF)
    array.run(0.001)
    assert array[0].read_memory(0x1000, 2) == b"\xff" + first_byte


def test_the_boot_section_is_as_large_as_the_fuses_say(avr: Compile) -> None:
    array = in_boot_section(avr, WRITE_PAGE)
    array[0].set_fuses(high=0xDD)  # 1024 words, from 0x3F800 on
    array.run(0.02)
    assert array[0].warnings[-1] == "SPM outside the boot section (from 0x3F800 on): no effect"


def test_a_reset_leads_where_the_fuses_say(avr: Compile) -> None:
    source = """
    __attribute__((section(".bootloader"), naked, used)) void boot(void) {
        asm volatile("ldi r24, 0x5B\\n sts 0x1000, r24\\n 1: rjmp 1b");
    }
    int main(void) { result[0] = 1; for (;;) { } }"""
    array = Array(avr(source, "-Wl,--section-start=.bootloader=0x3F000"))
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1) == b"\x01"
    array[0].set_fuses(high=0xDA)  # BOOTRST, 2048 words
    array.run(0.001)
    assert array[0].read_memory(0x1000, 1) == b"\x5b"


@pytest.mark.parametrize(
    ("source", "function"),
    [
        (
            "__attribute__((noinline)) uint8_t down(uint8_t n) { return down(n + 1) + n; }",
            "down",
        ),
        (
            "__attribute__((noinline)) uint16_t down(uint16_t n) {"
            " volatile uint8_t frame[200]; frame[n % 200] = n; return down(n + 1) + frame[0]; }",
            "down",
        ),
    ],
)
@pytest.mark.parametrize("data_bytes", [1000, 7000])
def test_a_stack_that_meets_the_data_stops_the_tile(
    avr: Compile, source: str, function: str, data_bytes: int
) -> None:
    elf = avr(
        f"volatile uint8_t data[{data_bytes}]; {source}\n"
        "int main(void) { data[0] = 1; data[1] = down(0); for (;;) { } }",
        "-O1", "-fno-optimize-sibling-calls", "-Wno-infinite-recursion",
    )  # fmt: skip
    array = Array(elf)
    with pytest.raises(TilencaError, match=rf"in {function}: the stack, grown down to 0x.*, meets the data"):
        array.run(0.1)
    assert array[0].stack.floor == 0x200 + data_bytes + data_bytes % 2


def test_a_stack_that_meets_the_heap_stops_the_tile(avr: Compile) -> None:
    source = """
    #include <stdlib.h>
    volatile uint8_t *block;
    __attribute__((noinline)) uint8_t down(uint8_t n) { return down(n + 1) + n; }
    int main(void) { block = malloc(4000); block[3999] = 1; _delay_us(50); block[0] = down(0); }"""
    array = Array(avr(source, "-O1", "-fno-optimize-sibling-calls", "-Wno-infinite-recursion"))
    with pytest.raises(TilencaError, match=r"in down: the stack, grown down to 0x.*, meets the data"):
        array.run(0.1)
    assert array[0].stack.floor > 0x200 + 4000


# Two tasks that hand over to each other, each on a stack of its own among the data.
TASKS = """
static uint8_t stacks[2][300];
static volatile uint16_t pointers[3], turns[2];
static volatile uint8_t current;
__attribute__((naked, noinline)) void swap(volatile uint16_t *save, volatile uint16_t *load) {
    asm volatile(".irp n, 10,11,12,13,14,15,16,17,28,29\\n push r\\\\n\\n .endr\\n"
                 "movw r30, r24\\n movw r26, r22\\n"
                 "in r28, 0x3D\\n in r29, 0x3E\\n st Z, r28\\n std Z+1, r29\\n"
                 "ld r28, X+\\n ld r29, X\\n" WRITE
                 ".irp n, 29,28,17,16,15,14,13,12,11,10\\n pop r\\\\n\\n .endr\\n ret\\n");
}
__attribute__((noinline)) static uint16_t deep(uint8_t n) { return n ? deep(n - 1) + n : 0; }
static void task(void) {
    for (;;) {
        uint8_t self = current;
        turns[self] += deep(30) == 465;
        current = 1 - self;
        swap(&pointers[self], &pointers[1 - self]);
    }
}
static void prepare(uint8_t n) {
    uint8_t *top = stacks[n] + sizeof stacks[n] - 1;
    uint32_t entry = (uint16_t)task;
    *top-- = entry; *top-- = entry >> 8; *top-- = entry >> 16;
    pointers[n] = (uint16_t)(top - 10);
}
int main(void) { prepare(0); prepare(1); swap(&pointers[2], &pointers[0]); for (;;) { } }
"""


@pytest.mark.parametrize(
    "write",
    [
        "out 0x3E, r29\\n out 0x3D, r28\\n",  # as compilers do
        "out 0x3D, r28\\n out 0x3E, r29\\n",  # as FreeRTOS does
    ],
)
def test_tasks_with_stacks_among_the_data_are_left_alone(avr: Compile, write: str) -> None:
    elf = avr(TASKS.replace("WRITE", f'"{write}"'), "-fno-optimize-sibling-calls", "-O1")
    array = Array(elf)
    array.run(0.01)
    turns = words(array[0].variable("turns"))
    assert all(turn in range(20, 400) for turn in turns)
    assert abs(turns[0] - turns[1]) <= 1


def test_a_tile_that_was_programmed_anew_has_another_image_s_data(avr: Compile) -> None:
    code = """
        boot_page_erase(PAGE); boot_spm_busy_wait(); boot_page_fill(PAGE, 0xBEEF);
        boot_page_write(PAGE); boot_spm_busy_wait(); boot_rww_enable();
        for (uint16_t n = 0; n < 2000; n++) asm volatile("push r1");
        for (uint16_t n = 0; n < 2000; n++) asm volatile("pop r0");
    """
    source = (
        BOOT.replace("CODE", code) + "volatile uint8_t data[7000]; uint8_t keep(void) { return data[0]; }"
    )
    places = ("-Wl,--section-start=.bootloader=0x3E000", "-Wl,--section-start=.table=0x8000")
    array = Array(avr(source, "-Wno-unused", *places))
    array.run(0.02)
    assert array[0].stack.most_bytes > 2000
    assert array[0].stack.floor == 0x200
