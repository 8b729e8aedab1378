// Fuse and lock bytes: bits that are 0 are programmed (data sheet, sections 30.1 and 30.2).
#pragma once

#include "avr/program.h"

#include <cstdint>

namespace tilenca::avr {

struct Fuses {
    uint8_t low = 0xFF, high = 0xD9, extended = 0xFD, lock = 0xFF;

    // An Arduino Mega as it is sold: starts in its boot section, which nobody may overwrite.
    static Fuses of_mega_with_bootloader() { return {0xFF, 0xD8, 0xFD, 0xCF}; }

    bool resets_to_boot() const { return (high & 0x01) == 0; }
    bool watchdog_always_on() const { return (high & 0x10) == 0; }
    bool starts_at_an_eighth() const { return (low & 0x80) == 0; }
    // First word of the boot section, the largest of which has 4096 words.
    uint32_t boot_start() const { return kFlashWords - (4096u >> (high >> 1 & 3)); }
    // Whether the lock bits forbid SPM there, and LPM from the other section.
    bool forbids_writing(bool boot_section) const { return (lock >> (boot_section ? 4 : 2) & 1) == 0; }
    bool forbids_reading(bool boot_section) const { return (lock >> (boot_section ? 5 : 3) & 1) == 0; }
};

} // namespace tilenca::avr
