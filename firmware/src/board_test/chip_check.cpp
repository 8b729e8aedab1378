#include "board_test/chip_check.h"

#include "board/boot.h"
#include "board/eeprom.h"
#include "board/fuses.h"
#include "board_test/say.h"

namespace tilenca {

namespace {

// As a Mega is made: 16 MHz resonator; a boot section of 8 KiB that starts first; brown-out at 2.7 V, or at
// 4.3 V (docs/how-to/bring-up.md).
constexpr uint8_t kLowFuse = 0xFF, kHighFuse = 0xD8, kExtendedFuse = 0xFD, kExtendedFuse43 = 0xFC;
constexpr uint8_t kHidesBootloader = 1 << 5; // BLB12 in the lock byte, 0: LPM cannot read the boot section

// No setting lies here.
constexpr uint8_t kEepromAddress = 255;

uint8_t write_and_read(uint8_t byte) {
    board::Eeprom::write(kEepromAddress, byte);
    while (board::Eeprom::busy()) {
    }
    return board::Eeprom::read(kEepromAddress);
}

} // namespace

bool check_fuses() {
    const board::Fuses found = board::fuses();
    const bool good = found.low == kLowFuse && found.high == kHighFuse &&
                      (found.extended == kExtendedFuse || found.extended == kExtendedFuse43);
    good ? say_pass(PSTR("fuses")) : say_fail(PSTR("fuses"));
    if (good) {
        say(PSTR(", "));
    }
    say(PSTR("low "));
    say_hex(found.low);
    say(PSTR(" high "));
    say_hex(found.high);
    say(PSTR(" extended "));
    say_hex(found.extended);
    say(PSTR(" lock "));
    say_hex(found.lock);
    if (!good) {
        say(PSTR(", and a Mega has FF D8 FD: set them with a programmer"));
    }
    say_end();
    return good;
}

bool check_bootloader() {
    if (!(board::fuses().lock & kHidesBootloader)) {
        say_pass(PSTR("bootloader"));
        say(PSTR(", hidden by its lock bits: that it was programmed over USB shows that it is there"));
        say_end();
        return true;
    }
    const uint32_t id = board::bootloader_id();
    if (id == 0) {
        say_fail(PSTR("bootloader"));
        say(PSTR("none: write one with a programmer"));
    } else {
        say_pass(PSTR("bootloader"));
        say(PSTR(", id "));
        for (uint8_t shift = 32; shift != 0; shift -= 8) {
            say_hex(static_cast<uint8_t>(id >> (shift - 8)));
        }
    }
    say_end();
    return id != 0;
}

bool check_eeprom() {
    const uint8_t before = board::Eeprom::read(kEepromAddress);
    constexpr uint8_t kPatterns[] = {0x55, 0xAA};
    for (uint8_t byte : kPatterns) {
        const uint8_t read = write_and_read(byte);
        if (read != byte) {
            say_fail(PSTR("EEPROM"));
            say(PSTR("wrote "));
            say_hex(byte);
            say(PSTR(" and read "));
            say_hex(read);
            say(PSTR(": the chip keeps no settings"));
            say_end();
            return false;
        }
    }
    write_and_read(before);
    say_pass(PSTR("EEPROM"));
    say_end();
    return true;
}

} // namespace tilenca
