"""What Arduino programs use: the core's functions, and Debian's libraries with their own examples."""

import binascii
from itertools import pairwise
from pathlib import Path

import pytest

from support.avr import ARDUINO, Compile
from support.avr import IdealArray as Array
from tilenca.emulator import EmulatedTile

EXAMPLES = sorted(ARDUINO.glob("libraries/*/examples/*/*.ino"))
# Those that join two boards by I2C: here nobody is at the other end, and what that costs is told.
SLAVES = {"slave_receiver", "slave_sender"}


def example(name: str) -> Path:
    (found,) = [path for path in EXAMPLES if path.stem == name]
    return found


def library_of(path: Path) -> str:
    return path.parts[-4]


def run(elf: object, seconds: float) -> EmulatedTile:
    array = Array(str(elf))
    array.run(seconds)
    return array[0]


# --- Debian's libraries ---


@pytest.mark.parametrize("path", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_every_example_runs(arduino: Compile, path: Path) -> None:
    array = Array(arduino(path, *{library_of(path), "SPI", "Wire", "SoftwareSerial"}))
    array[0].set_spi_loopback()
    array.run(0.3)
    expected = ["TWI as slave (TWAR): nobody addresses it"] if path.stem in SLAVES else []
    assert array[0].warnings == expected
    assert array[0].function  # it is somewhere sensible
    assert array[0].stack.most_bytes in range(8, 600)


def test_the_i2c_scanner_finds_nobody(arduino: Compile) -> None:
    said = run(arduino(example("i2c_scanner"), "Wire"), 1.0).read_serial().decode()
    assert said.splitlines()[:4] == ["", "I2C Scanner", "Scanning...", "No I2C devices found"]


def test_an_eeprom_is_read_out(arduino: Compile) -> None:
    array = Array(arduino(example("eeprom_read"), "EEPROM"))
    array[0].write_eeprom(0, bytes([7, 99, 250]))
    array.run(2.0)
    said = array[0].read_serial().decode().split("\r\n")
    assert said[:4] == ["0\t7", "1\t99", "2\t250", "3\t255"]


def test_an_eeprom_is_cleared_in_the_time_it_takes(arduino: Compile) -> None:
    array = Array(arduino(example("eeprom_clear"), "EEPROM"))
    array[0].write_eeprom(0, bytes(range(256)) * 16)
    array.run(13.0)
    assert array[0].read_eeprom(4095, 1) == b"\xff"
    array.run(1.2)
    assert array[0].read_eeprom() == bytes(4096)
    assert array[0].pin("B", 7)  # the LED: done


def their_checksum(data: bytes) -> int:
    """The example's own: a CRC-32 that is inverted after every byte."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc = binascii.crc32(bytes([byte]), crc ^ 0xFFFFFFFF)
    return crc


def test_an_eeprom_s_checksum_is_ours(arduino: Compile) -> None:
    array = Array(arduino(example("eeprom_crc"), "EEPROM"))
    contents = bytes(n * n % 251 for n in range(4096))
    array[0].write_eeprom(0, contents)
    array.run(2.0)
    said = array[0].read_serial().decode()
    assert f"CRC32 of EEPROM data: 0x{their_checksum(contents):X}\r\n" in said


def test_values_put_into_an_eeprom_come_out_again(arduino: Compile) -> None:
    array = Array(arduino(example("eeprom_put"), "EEPROM"))
    array.run(1.0)
    assert "Written float data type!" in array[0].read_serial().decode()
    reader = Array(arduino(example("eeprom_get"), "EEPROM"))
    reader[0].write_eeprom(0, array[0].read_eeprom())
    reader.run(1.0)
    said = reader[0].read_serial().decode()
    assert "123.456" in said
    assert "Working!" in said


SPI_SKETCH = """
#include <SPI.h>
void setup() {
    Serial.begin(115200); SPI.begin();
    SPI.beginTransaction(SPISettings(1000000, MSBFIRST, SPI_MODE0));
    uint8_t a = SPI.transfer(0x5C); uint16_t b = SPI.transfer16(0xBEEF);
    uint8_t c[3] = {1, 2, 3}; SPI.transfer(c, 3);
    SPI.endTransaction();
    Serial.print(a, HEX); Serial.print(' '); Serial.print(b, HEX); Serial.print(' '); Serial.println(c[2]);
}
void loop() {}
"""


def test_the_spi_library_transfers(arduino: Compile) -> None:
    array = Array(arduino(SPI_SKETCH, "SPI"))
    array[0].set_spi_loopback()
    clock = array[0].probe("B", 1)
    array.run(0.01)
    assert array[0].read_serial() == b"5C BEEF 3\r\n"
    rises = [edge.time_s for edge in clock.read() if edge.level]
    assert len(rises) == 8 * 6
    assert rises[1] - rises[0] == pytest.approx(1e-6, abs=1e-9)


SOFT = """
#include <SoftwareSerial.h>
SoftwareSerial soft(10, 11);
void setup() { Serial.begin(115200); soft.begin(BAUD); soft.print("Hello, wire"); }
void loop() {
    if (soft.available()) Serial.write(soft.read());
    if (Serial.available()) soft.write(Serial.read());
}
"""


def feed(tile: EmulatedTile, port: str, bit: int, baud: int, data: bytes, start_s: float) -> None:
    """Lets a line say bytes, as 8N1 with two stop bits."""
    for number, value in enumerate(data):
        for place in range(11):
            level = bool((value << 1 | 0x600) >> place & 1)
            cycle = round((start_s + (11 * number + place) / baud) * 16e6)
            tile.push_edge(port, bit, cycle, level)


@pytest.mark.parametrize("baud", [4800, 9600, 38400, 57600])
def test_software_serial_talks_both_ways(arduino: Compile, baud: int) -> None:
    array = Array(arduino(SOFT.replace("BAUD", str(baud)), "SoftwareSerial"))
    tap = array[0].tap_pin("B", 5, baud)
    array.run(0.05)
    assert bytes(byte.value for byte in tap.read()) == b"Hello, wire"
    feed(array[0], "B", 4, baud, b"to the chip, bit by bit", 0.051)
    array.run(0.1)
    assert array[0].read_serial() == b"to the chip, bit by bit"
    array[0].write_serial(b"ok")  # no more: it is deaf while it sends, and the USART keeps three bytes
    array.run(0.05)
    assert bytes(byte.value for byte in tap.read()) == b"ok"


# --- the core ---


def test_time_is_told_to_the_microsecond(arduino: Compile) -> None:
    source = """
    void setup() {
        Serial.begin(115200);
        delay(100); unsigned long m = millis(), u = micros(); delayMicroseconds(500); u = micros() - u;
        unsigned long v = micros(); delay(250); v = micros() - v;
        Serial.println(m); Serial.println(u); Serial.println(v);
    }
    void loop() {}"""
    said = run(arduino(source), 0.5).read_serial().split()
    # millis() counts in steps of 1.024 ms; micros() in steps of 4 us.
    assert [int(word) for word in said] == [99, pytest.approx(504, abs=8), pytest.approx(250_004, abs=12)]


PWM_PINS = {
    2: ("E", 4), 3: ("E", 5), 4: ("G", 5), 5: ("E", 3), 6: ("H", 3), 7: ("H", 4), 8: ("H", 5), 9: ("H", 6),
    10: ("B", 4), 11: ("B", 5), 12: ("B", 6), 13: ("B", 7), 44: ("L", 5), 45: ("L", 4), 46: ("L", 3),
}  # fmt: skip


def test_every_pwm_pin_has_the_duty_it_was_given(arduino: Compile) -> None:
    writes = " ".join(f"analogWrite({pin}, {10 * number + 20});" for number, pin in enumerate(PWM_PINS))
    array = Array(arduino(f"void setup() {{ {writes} }} void loop() {{}}"))
    array.run(0.01)
    probes = {pin: array[0].probe(*place) for pin, place in PWM_PINS.items()}
    array.run(0.05)
    for number, (pin, place) in enumerate(PWM_PINS.items()):
        asked = 10 * number + 20
        fast = pin in (4, 13)  # timer 0
        expected = (asked + 1) / 256 if fast else asked / 255
        assert array[0].duty(*place) == pytest.approx(expected, abs=1e-9), pin
        edges = probes[pin].read()
        rises = [edge.time_s for edge in edges if edge.level]
        falls = [edge.time_s for edge in edges if not edge.level and edge.time_s > rises[0]]
        high = sum(fall - rise for rise, fall in zip(rises, falls, strict=False)) / min(
            len(rises), len(falls)
        )
        period = (rises[-1] - rises[0]) / (len(rises) - 1)
        assert high / period == pytest.approx(expected, abs=1e-6), pin
        assert 1 / period == pytest.approx(976.5625 if fast else 490.196, abs=0.01), pin


@pytest.mark.parametrize("frequency", [31, 440, 4000, 20000])
def test_a_tone_has_its_pitch_and_its_length(arduino: Compile, frequency: int) -> None:
    array = Array(arduino(f"void setup() {{ tone(8, {frequency}, 100); }} void loop() {{}}"))
    probe = array[0].probe("H", 5)
    array.run(0.3)
    rises = [edge.time_s for edge in probe.read() if edge.level]
    assert (rises[-1] - rises[0]) / (len(rises) - 1) == pytest.approx(1 / frequency, rel=0.01)
    assert rises[-1] - rises[0] == pytest.approx(0.1, abs=1.5 / frequency)


def test_pulses_are_measured(arduino: Compile) -> None:
    source = """
    void setup() {
        Serial.begin(115200); pinMode(22, INPUT_PULLUP);
        Serial.println(pulseIn(22, LOW, 100000));
    }
    void loop() {}"""
    array = Array(arduino(source))
    array[0].push_edge("A", 0, 320_000, False)
    array[0].push_edge("A", 0, 320_000 + 16 * 1234, True)
    array.run(0.1)
    # It counts turns of 16 cycles; the interrupt of millis() takes about 6 us of them.
    assert int(array[0].read_serial()) in range(1224, 1236)


def test_interrupts_pins_and_shifting(arduino: Compile) -> None:
    source = """
    volatile int falls = 0;
    void seen() { falls++; }
    void setup() {
        Serial.begin(115200);
        pinMode(21, INPUT_PULLUP); attachInterrupt(digitalPinToInterrupt(21), seen, FALLING);
        pinMode(30, OUTPUT); pinMode(31, OUTPUT);
        shiftOut(30, 31, MSBFIRST, 0xB3);
        delay(50);
        Serial.print(falls); Serial.print(digitalRead(21)); Serial.print(digitalRead(22));
    }
    void loop() {}"""
    array = Array(arduino(source))
    data, clock = array[0].probe("C", 7), array[0].probe("C", 6)
    for number in range(7):
        array[0].push_edge("D", 0, 100_000 + 1000 * number, number % 2 == 1)
    array[0].hold_pin("A", 0, False)
    array.run(0.1)
    assert array[0].read_serial() == b"400"
    changes, value = data.read(), 0
    for rise in [edge.time_s for edge in clock.read() if edge.level]:
        value = value << 1 | [edge.level for edge in changes if edge.time_s <= rise][-1]
    assert value == 0xB3


SERVO = """
/* As the Servo library does: one compare channel gives several servos their pulses in turn. */
static const uint8_t pins[3] = {22, 23, 24};
static const uint16_t lengths[3] = {1000, 1500, 2000};
static volatile int8_t channel = -1;
ISR(TIMER5_COMPA_vect) {
    if (channel < 0) TCNT5 = 0; else digitalWrite(pins[channel], LOW);
    channel++;
    if (channel < 3) { OCR5A = TCNT5 + 2 * lengths[channel]; digitalWrite(pins[channel], HIGH); }
    else { OCR5A = 40000; channel = -1; }
}
void setup() {
    for (uint8_t i = 0; i < 3; i++) pinMode(pins[i], OUTPUT);
    TCCR5A = 0; TCCR5B = 2; TCNT5 = 0; OCR5A = 100; TIMSK5 = 2;
}
void loop() {}
"""


def test_servo_pulses_have_their_lengths_and_come_every_20_ms(arduino: Compile) -> None:
    array = Array(arduino(SERVO))
    probes = [array[0].probe("A", bit) for bit in range(3)]
    array.run(0.2)
    for probe, length_us in zip(probes, (1000, 1500, 2000), strict=True):
        edges = probe.read()[1:]
        rises = [edge.time_s for edge in edges if edge.level]
        falls = [edge.time_s for edge in edges if not edge.level]
        assert (falls[-1] - rises[-1]) * 1e6 == pytest.approx(length_us, abs=8)
        assert {round((b - a) * 1e3) for a, b in pairwise(rises)} == {20}


def test_four_serial_ports_at_once(arduino: Compile) -> None:
    source = """
    void setup() {
        Serial.begin(9600); Serial1.begin(19200, SERIAL_8N1); Serial2.begin(38400); Serial3.begin(115200);
        for (int i = 0; i < 20; i++) {
            Serial.print(i); Serial1.print(i); Serial2.print(i); Serial3.print(i);
        }
        Serial.print(3.14159, 3); Serial.print(' '); Serial.print(String("x") + 42 + 'y');
        Serial.print(-7, BIN);
    }
    void loop() {}"""
    array = Array(arduino(source))
    taps = [array[0].tap_pin(port, bit) for port, bit in (("D", 3), ("H", 1), ("J", 1))]
    array.run(0.2)
    counted = "".join(map(str, range(20))).encode()
    assert array[0].read_serial() == counted + b"3.142 x42y" + b"1" * 29 + b"001"
    assert [bytes(byte.value for byte in tap.read()) for tap in taps] == [counted] * 3


def test_analog_inputs_are_read_by_their_names(arduino: Compile) -> None:
    reads = "".join(f"Serial.println(analogRead(A{channel}));" for channel in range(16))
    array = Array(arduino(f"void setup() {{ Serial.begin(115200); {reads} }} void loop() {{}}"))
    for channel in range(16):
        array[0].set_analog(channel, 1000 - 50 * channel)
    array.run(0.05)
    assert [int(word) for word in array[0].read_serial().split()] == [1000 - 50 * n for n in range(16)]


def test_the_watchdog_restarts_a_sketch(arduino: Compile) -> None:
    source = """
    #include <avr/wdt.h>
    void setup() { Serial.begin(115200); Serial.println(F("start")); Serial.flush(); wdt_enable(WDTO_120MS); }
    void loop() {}"""
    said = run(arduino(source), 0.5).read_serial().decode()
    assert said == "start\r\n" * 4  # 128 ms each
