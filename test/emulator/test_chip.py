"""EEPROM, ADC, self-made faults, and what is not modelled."""

import pytest
from conftest import Compile, words

from tilenca.emulator import Array
from tilenca.errors import TilencaError


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
        ADCSRA = 0x87; TCCR5B = 1;
        for (uint8_t channel = 0; channel < 16; channel++) {
            ADMUX = 0x40 | (channel & 7); ADCSRB = channel & 8;
            TCNT5 = 0;
            ADCSRA |= 0x40;
            while (ADCSRA & 0x40) { }
            uint16_t took = TCNT5;
            result16[channel] = ADC;
            if (channel < 2) result16[16 + channel] = took;
        }
        for (;;) { }
    }"""
    array = Array(avr(source))
    for channel in range(16):
        array[0].set_analog(channel, 60 * channel + 7)
    array.run(0.01)
    memory = words(array[0].read_memory(0x1000, 36))
    assert memory[:16] == [60 * channel + 7 for channel in range(16)]
    assert memory[16:] == pytest.approx([25 * 128, 13 * 128], abs=16)


@pytest.mark.parametrize(
    ("source", "fact"),
    [
        ('asm volatile(".word 0xFF0F");', "in main: illegal instruction"),
        ('asm volatile("jmp 0x20000");', "ran into erased flash"),
        (
            'asm volatile("ldi r30, 0\\n out 0x3C, r30\\n ldi r31, 0x80\\n ijmp" ::: "r30", "r31");',
            "ran into erased",
        ),
        ('EIND = 3; asm volatile("eijmp");', "ran off the end of flash"),
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
        for (uint8_t i = 0; i < 3; i++) { SPCR = 0x50; TWCR = 0xA4; }
        result[0] = SPCR; *(volatile uint8_t *)0x3000 = 1;
        for (;;) { }
    }"""
    array = Array(avr(source))
    array.run(0.001)
    assert array[0].warnings == [
        "SPI (SPCR)",
        "TWI (TWCR)",
        "write beyond the end of SRAM (first: address 0x3000)",
    ]
    assert array[0].read_memory(0x1000, 1) == b"\x50"


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
