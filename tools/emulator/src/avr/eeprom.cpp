#include "avr/eeprom.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kEecr = 0x3F, kEedr = 0x40, kEearl = 0x41, kEearh = 0x42;
constexpr uint8_t kEere = 1, kEepe = 2, kEempe = 4, kEerie = 8, kEepm = 0x30;

// Timed by the chip's own calibrated oscillator, not by the crystal; given here in cycles of a 16 MHz clock.
constexpr uint64_t kEraseAndWriteCycles = 54'400; // 3.4 ms
constexpr uint64_t kSingleCycles = 28'800;        // 1.8 ms, erase only or write only
constexpr uint64_t kArmedCycles = 4;

} // namespace

std::vector<uint16_t> Eeprom::registers() const {
    return {kEecr};
}

std::vector<uint8_t> Eeprom::vectors() const {
    return {kVectorEeprom};
}

uint8_t Eeprom::read(uint16_t, uint64_t cycle) {
    const uint8_t armed = cycle <= armed_until_ ? kEempe : 0;
    return static_cast<uint8_t>((byte(kEecr) & (kEepm | kEerie)) | armed | (busy_ ? kEepe : 0));
}

void Eeprom::write(uint16_t, uint8_t value, uint64_t cycle) {
    const bool armed = cycle <= armed_until_;
    if (!busy_) {
        byte(kEecr) = value & (kEepm | kEerie);
    } else {
        byte(kEecr) = static_cast<uint8_t>((byte(kEecr) & kEepm) | (value & kEerie));
    }
    if ((value & kEempe) != 0 && !armed) {
        armed_until_ = cycle + kArmedCycles;
    }
    if ((value & kEepe) != 0 && armed && !busy_) {
        start_write(cycle);
    } else if ((value & kEere) != 0 && !busy_) {
        byte(kEedr) = memory_[(byte(kEearl) | byte(kEearh) << 8) % kEepromBytes];
        core_.cpu.stall_cycles += 4;
    }
    update_requests();
}

void Eeprom::start_write(uint64_t cycle) {
    uint8_t& cell = memory_[(byte(kEearl) | byte(kEearh) << 8) % kEepromBytes];
    const uint8_t mode = byte(kEecr) >> 4 & 3; // 0 erase and write, 1 erase only, 2 write only
    const uint8_t erased = mode == 2 ? cell : 0xFF;
    cell = mode == 1 ? 0xFF : erased & byte(kEedr);
    busy_ = true;
    armed_until_ = 0;
    core_.cpu.stall_cycles += 2;
    core_.schedule.set(Slot::Eeprom,
                       cycle + (mode == 0 ? kEraseAndWriteCycles : kSingleCycles) / core_.cpu.clock_divisor);
}

void Eeprom::on_event(Slot, uint64_t) {
    busy_ = false;
    core_.schedule.cancel(Slot::Eeprom);
    update_requests();
}

void Eeprom::update_requests() {
    core_.cpu.request(kVectorEeprom, !busy_ && (byte(kEecr) & kEerie) != 0);
}

// A write under way goes on through a reset.
void Eeprom::reset(uint64_t) {
    armed_until_ = 0;
}

} // namespace tilenca::avr
