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
    // The start-up times of a crystal (data sheet, tables 10-4 and 10-6), and what every reset adds.
    struct StartUp {
        uint64_t crystal_cycles;
        uint64_t watchdog_ticks;
    };
    static constexpr uint64_t kResetCycles = 14;
    StartUp start_up() const {
        constexpr uint64_t kShort = 512, kLong = 8192; // nominally 4.1 ms and 65 ms
        constexpr StartUp kTimes[8] = {
            {258, kShort}, {258, kLong}, {1024, 0},       {1024, kShort},
            {1024, kLong}, {16384, 0},   {16384, kShort}, {16384, kLong},
        };
        return kTimes[(low & 1) << 2 | (low >> 4 & 3)]; // CKSEL0, SUT1 and SUT0
    }
    bool starts_at_an_eighth() const { return (low & 0x80) == 0; }
    // First word of the boot section, the largest of which has 4096 words.
    uint32_t boot_start() const { return kFlashWords - (4096u >> (high >> 1 & 3)); }
    // Whether the lock bits forbid SPM there, and LPM from the other section.
    bool forbids_writing(bool boot_section) const { return (lock >> (boot_section ? 4 : 2) & 1) == 0; }
    bool forbids_reading(bool boot_section) const { return (lock >> (boot_section ? 5 : 3) & 1) == 0; }
};

} // namespace tilenca::avr
