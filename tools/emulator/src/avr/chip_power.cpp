// Which clocks run: sleep modes, power reduction, held prescalers, the system clock's prescaler.
#include "avr/chip.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kGtccr = 0x43, kSmcr = 0x53, kClkpr = 0x61, kPrr0 = 0x64, kPrr1 = 0x65;
constexpr uint8_t kChangeEnable = 0x80, kMostShifts = 8;
constexpr uint8_t kPsrSync = 1, kPsrAsync = 2, kTsm = 0x80;

enum class SleepMode : uint8_t { Idle = 0, NoiseReduction = 1, PowerDown = 2, PowerSave = 3 };

// What it takes a crystal to come up again (data sheet, table 10-4, at the Mega's fuses), and an oscillator
// that was kept running.
constexpr uint64_t kCrystalCycles = 16384, kStandbyCycles = 6;

} // namespace

void Chip::update_clocks(uint64_t cycle) {
    const auto mode = static_cast<SleepMode>(cpu_.data[kSmcr] >> 1 & 7);
    const uint8_t first = cpu_.data[kPrr0], second = cpu_.data[kPrr1], held = cpu_.data[kGtccr];
    const auto set = [cycle](Peripheral& unit, bool stands, bool reduced) {
        unit.set_reduced(reduced);
        if (stands) {
            unit.stop_clock(cycle);
        } else {
            unit.start_clock(cycle);
        }
    };
    const bool sync_held = (held & kTsm) != 0 && (held & kPsrSync) != 0;
    const bool own_held = (held & kTsm) != 0 && (held & kPsrAsync) != 0;
    prescaler_.set_stands(cpu_.deeply || sync_held, cycle); // power reduction does not reach it
    constexpr uint8_t kTimerBit[6] = {5, 3, 6, 3, 4, 5};
    for (unsigned i = 0; i < timers_.size(); i++) {
        const bool reduced = ((i < 3 ? first : second) >> kTimerBit[i] & 1) != 0;
        const bool stands =
            cpu_.deeply || reduced || (timers_[i]->has_own_prescaler() ? own_held : sync_held);
        if (timers_[i]->has_own_prescaler()) { // it is a part of the timer, and stands with it
            own_prescaler_.set_stands(stands, cycle);
        }
        timers_[i]->take_back(); // a write shall not pass it by from now on
        set(*timers_[i], stands, reduced);
    }
    for (unsigned i = 0; i < usarts_.size(); i++) {
        const bool reduced = (i == 0 ? first >> 1 & 1 : second >> (i - 1) & 1) != 0;
        set(*usarts_[i], cpu_.deeply || reduced, reduced);
    }
    const bool spi_off = (first & 0x04) != 0, twi_off = (first & 0x80) != 0, adc_off = (first & 0x01) != 0;
    set(*spi_, cpu_.deeply || spi_off, spi_off);
    set(*twi_, cpu_.deeply || twi_off, twi_off);
    set(*adc_, (cpu_.deeply && mode != SleepMode::NoiseReduction) || adc_off, adc_off);
}

void Chip::sleep_changed(bool asleep, uint64_t cycle) {
    const auto mode = static_cast<SleepMode>(cpu_.data[kSmcr] >> 1 & 7);
    const bool was_deep = cpu_.deeply;
    cpu_.deeply = asleep && mode != SleepMode::Idle;
    cpu_.wake_cycles = 0;
    if (cpu_.deeply == was_deep) {
        return;
    }
    if (cpu_.deeply && mode != SleepMode::NoiseReduction) {
        const bool crystal_stops = mode == SleepMode::PowerDown || mode == SleepMode::PowerSave;
        cpu_.wake_cycles = crystal_stops ? kCrystalCycles : kStandbyCycles;
    }
    update_clocks(cycle);
    if (cpu_.deeply && mode == SleepMode::NoiseReduction) {
        adc_->start_quietly(cycle);
    }
}

// CLKPCE alone opens the other bits for four cycles.
void Chip::write_clock_prescaler(uint8_t value, uint64_t cycle) {
    if (value == kChangeEnable) {
        prescaler_changeable_until_ = cycle + 4;
        return;
    }
    const uint8_t shifts = value & 15;
    if (cycle <= prescaler_changeable_until_ && (value & kChangeEnable) == 0 && shifts <= kMostShifts) {
        cpu_.data[kClkpr] = shifts;
        cpu_.clock_divisor = 1u << shifts;
        cpu_.yields = true;
        cpu_.end_soon();
        prescaler_changeable_until_ = 0;
    }
}

} // namespace tilenca::avr
