// How a chip starts: power, resets, start-up time, and what SRAM holds by then.
#include "avr/chip.h"

#include "avr/registers.h"

#include <algorithm>
#include <cstring>

namespace tilenca::avr {

namespace {

constexpr uint16_t kMcusr = 0x54, kClkpr = 0x61, kOsccal = 0x66;

} // namespace

void Chip::set_hardware(const Hardware& hardware) {
    hardware_ = hardware;
    Random random(hardware.seed);
    gpio_->noise().set(hardware.floating_inputs, random.next());
    watchdog_->set_error(hardware.watchdog_error * (2 * random.uniform() - 1));
    random_ = Random(random.next());
    power_on();
}

// The program begins when the start-up time has passed, in which nothing runs.
void Chip::reset(ResetCause cause) {
    restart(cause);
    cpu_.cycle += start_up_cycles(cause);
    prescaler_.reset(cpu_.cycle);
    own_prescaler_.reset(cpu_.cycle);
    const bool by_watchdog = (cpu_.data[kMcusr] & static_cast<uint8_t>(ResetCause::Watchdog)) != 0;
    if (by_watchdog || fuses_.watchdog_always_on()) {
        watchdog_->force_on(cpu_.cycle);
    }
}

uint64_t Chip::start_up_cycles(ResetCause cause) const {
    if (!hardware_.start_up) {
        return 0;
    }
    const Fuses::StartUp time = fuses_.start_up();
    const uint64_t crystal = cause == ResetCause::PowerOn ? time.crystal_cycles : 0;
    return (crystal + Fuses::kResetCycles) / cpu_.clock_divisor + watchdog_->cycles(time.watchdog_ticks);
}

void Chip::restart(ResetCause cause) {
    const uint8_t causes = cause == ResetCause::PowerOn ? 0 : cpu_.data[kMcusr];
    cpu_.reset(fuses_.resets_to_boot() ? fuses_.boot_start() : 0);
    for (uint16_t address = kIoStart; address < kSramStart; address++) {
        cpu_.data[address] = kRegisters.reset[address];
    }
    cpu_.data[kOsccal] = SelfProgramming::kCalibration;
    cpu_.data[kMcusr] = causes | static_cast<uint8_t>(cause);
    vectors_movable_until_ = prescaler_changeable_until_ = jtag_changeable_until_ = 0;
    update_clocks(cpu_.cycle);
    for (Peripheral* peripheral : all_) {
        peripheral->reset(cpu_.cycle);
    }
    const uint32_t divisor = fuses_.starts_at_an_eighth() ? 8 : 1;
    cpu_.data[kClkpr] = divisor == 8 ? 3 : 0;
    cpu_.yields = cpu_.clock_divisor != divisor;
    cpu_.clock_divisor = divisor;
}

void Chip::forget_sram() {
    std::memset(cpu_.data, 0, sizeof cpu_.data);
    for (uint16_t at = 0; hardware_.sram_noise && at < kDataBytes; at++) {
        cpu_.data[at] = at < kIoStart || at >= kSramStart ? static_cast<uint8_t>(random_.next() >> 56) : 0;
    }
    cpu_.fault.clear();
    cpu_.stack_deepest = kDataBytes;
}

void Chip::power_off() {
    forget_sram();
    restart(ResetCause::PowerOn);
}

void Chip::power_on() {
    forget_sram();
    reset(ResetCause::PowerOn);
}

void Chip::pass_while_off(uint64_t cycle) {
    cpu_.cycle = std::max(cpu_.cycle, cycle);
}

} // namespace tilenca::avr
