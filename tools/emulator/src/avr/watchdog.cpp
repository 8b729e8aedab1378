#include "avr/watchdog.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kWdtcsr = 0x60, kMcusr = 0x54;
constexpr uint8_t kWdif = 0x80, kWdie = 0x40, kWdp3 = 0x20, kWdce = 0x10, kWde = 0x08, kWdrf = 0x08;
constexpr uint64_t kCyclesPerTick = 125; // 16 MHz / 128 kHz
constexpr uint64_t kShortestTicks = 2048;
constexpr uint64_t kChangeCycles = 4;

} // namespace

std::vector<uint16_t> Watchdog::registers() const {
    return {kWdtcsr};
}

std::vector<uint8_t> Watchdog::vectors() const {
    return {kVectorWatchdog};
}

bool Watchdog::is_on() const {
    return (byte(kWdtcsr) & (kWde | kWdie)) != 0;
}

void Watchdog::write(uint16_t, uint8_t value, uint64_t cycle) {
    const uint8_t before = byte(kWdtcsr);
    const bool changeable = cycle <= changeable_until_;
    if ((value & kWdce) != 0 && (value & kWde) != 0 && !changeable) {
        changeable_until_ = cycle + kChangeCycles;
    }
    uint8_t after = static_cast<uint8_t>((value & kWdif) != 0 ? 0 : before & kWdif);
    after |= value & kWdie;
    if (changeable) {
        const bool forced = (byte(kMcusr) & kWdrf) != 0;
        after |= (value & (kWdp3 | 7 | kWde)) | (forced ? kWde : 0);
        changeable_until_ = 0;
    } else {
        after |= (before & (kWdp3 | 7 | kWde)) |
                 (value & kWde); // it can be switched on, but neither off nor slower
    }
    if (fuses_.watchdog_always_on()) {
        after = static_cast<uint8_t>((after | kWde) & ~kWdie);
    }
    byte(kWdtcsr) = after;
    const bool was_on = (before & (kWde | kWdie)) != 0;
    if (is_on() != was_on || ((before ^ after) & (kWdp3 | 7)) != 0) {
        restart(cycle);
    }
    update_requests();
}

void Watchdog::restart(uint64_t cycle) {
    const uint8_t control = byte(kWdtcsr);
    const unsigned scale = (control & 7u) | ((control & kWdp3) != 0 ? 8u : 0u);
    const uint64_t ticks = kShortestTicks << (scale > 9 ? 9 : scale);
    core_.schedule.set(Slot::Watchdog, is_on() ? cycle + cycles(ticks) : kNever);
}

uint64_t Watchdog::cycles(uint64_t ticks) const {
    const double whole = static_cast<double>(ticks * kCyclesPerTick) / (1 + error_);
    return static_cast<uint64_t>(whole) / core_.cpu.clock_divisor;
}

// In "interrupt and reset" mode a second time-out resets, if the interrupt of the first still waits.
void Watchdog::on_event(Slot, uint64_t cycle) {
    const uint8_t control = byte(kWdtcsr);
    const bool last_chance_gone = (control & kWde) != 0 && (control & kWdif) != 0;
    if ((control & kWdie) != 0 && !last_chance_gone) {
        byte(kWdtcsr) |= kWdif;
        update_requests();
        restart(cycle);
    } else {
        core_.schedule.cancel(Slot::Watchdog);
        wants_reset_ = true;
    }
}

// In "interrupt and reset" mode the interrupt disarms itself: the next time-out resets, too.
void Watchdog::interrupt_taken(uint8_t) {
    byte(kWdtcsr) &= static_cast<uint8_t>(~kWdif);
    if ((byte(kWdtcsr) & kWde) != 0) {
        byte(kWdtcsr) &= static_cast<uint8_t>(~kWdie);
    }
    update_requests();
}

void Watchdog::update_requests() {
    const uint8_t control = byte(kWdtcsr);
    core_.cpu.request(kVectorWatchdog, (control & kWdif) != 0 && (control & kWdie) != 0);
}

void Watchdog::reset(uint64_t) {
    wants_reset_ = false;
    changeable_until_ = 0;
    core_.schedule.cancel(Slot::Watchdog);
}

void Watchdog::force_on(uint64_t cycle) {
    byte(kWdtcsr) = kWde;
    restart(cycle);
}

} // namespace tilenca::avr
