#include "avr/chip.h"

#include "avr/ops.h"
#include "avr/registers.h"
#include "avr/unmodelled.h"

#include <cstring>

namespace tilenca::avr {

namespace {

constexpr uint16_t kPinFirst = 0x20, kFlagsFirst = 0x35, kFlagsLast = 0x3C, kGtccr = 0x43, kSmcr = 0x53;
constexpr uint16_t kMcusr = 0x54, kMcucr = 0x55, kSreg = 0x5F;
constexpr uint8_t kIvce = 1, kIvsel = 2, kPud = 0x10, kJtd = 0x80;
constexpr uint16_t kDidr2 = 0x7D, kDidr0 = 0x7E, kDidr1 = 0x7F;
constexpr uint64_t kSequenceCycles = 4; // so long a protected bit can be changed after it was unlocked
constexpr uint8_t kPsrSync = 1, kPsrAsync = 2, kTsm = 0x80;
constexpr uint16_t kClkpr = 0x61, kPrr0 = 0x64, kPrr1 = 0x65, kSpl = 0x5D, kSph = 0x5E;
constexpr uint8_t kSleepEnable = 1;

// Registers in which a written one acts on that bit alone, and a zero does nothing: flags, and PIN's toggles.
bool acts_by_ones(uint16_t address) {
    const bool is_pin = address >= kPinFirst && address < kFlagsFirst - 1 && (address - kPinFirst) % 3 == 0;
    return is_pin || (address >= kFlagsFirst && address <= kFlagsLast);
}

} // namespace

Chip::Chip(std::shared_ptr<Program> program, const Fuses& fuses)
    : image_(std::move(program)), program_(image_), fuses_(fuses), schedule_(cpu_) {
    std::memset(cpu_.data, 0, sizeof cpu_.data);
    std::memset(cpu_.special, 0, sizeof cpu_.special);
    cpu_.bus = this;
    cpu_.use(*program_);
    const Core core{cpu_, schedule_, warnings_};
    gpio_ = std::make_unique<Gpio>(core);
    eeprom_ = std::make_unique<Eeprom>(core);
    adc_ = std::make_unique<Adc>(core);
    comparator_ = std::make_unique<Comparator>(core, *adc_);
    spi_ = std::make_unique<Spi>(core, *gpio_);
    twi_ = std::make_unique<Twi>(core);
    watchdog_ = std::make_unique<Watchdog>(core, fuses_);
    self_programming_ = std::make_unique<SelfProgramming>(core, program_, fuses_);
    // Ports come first: a saved state is loaded in this order, and others enter themselves there again.
    attach(*gpio_);
    for (unsigned i = 0; i < timers_.size(); i++) {
        timers_[i] = std::make_unique<Timer>(core, *gpio_, i == 2 ? own_prescaler_ : prescaler_, i);
        attach(*timers_[i]);
    }
    for (unsigned i = 0; i < usarts_.size(); i++) {
        usarts_[i] = std::make_unique<Usart>(core, *gpio_, i);
        attach(*usarts_[i]);
        gpio_->attach_line(usarts_[i]->receive_pin(), Drive::Open); // a receiver listens to a line
    }
    const std::initializer_list<Peripheral*> others = {
        eeprom_.get(), adc_.get(),      comparator_.get(),      spi_.get(),
        twi_.get(),    watchdog_.get(), self_programming_.get()};
    for (Peripheral* one : others) {
        attach(*one);
    }
    for (uint16_t address = kIoStart; address < kSramStart; address++) {
        const bool inputs_off = address >= kDidr2 && address <= kDidr1;
        const bool system = inputs_off || address == kGtccr || address == kMcusr || address == kMcucr ||
                            address == kClkpr || address == kPrr0 || address == kPrr1;
        // Stored bytes: what is written is looked at, or loses the bits that do not exist.
        if (system || is_unmodelled(address) || kRegisters.implemented[address] != 0xFF) {
            cpu_.special[address] |= kWritesThroughBus;
        }
    }
    cpu_.special[kSpl] = cpu_.special[kSph] = kWritesThroughBus;
    cpu_.special[kSreg] = kReadsThroughBus | kWritesThroughBus;
    for (size_t slot = 0; slot < kSlots; slot++) {
        at_slot_[slot] = &find_at_slot(static_cast<Slot>(slot));
    }
    join();
    reset(ResetCause::PowerOn);
}

Chip::~Chip() = default;

void Chip::attach(Peripheral& peripheral) {
    for (const uint16_t address : peripheral.registers()) {
        at_address_[address] = &peripheral;
        const bool is_stored = peripheral.reads_as_stored(address);
        cpu_.special[address] = is_stored ? kWritesThroughBus : kReadsThroughBus | kWritesThroughBus;
        cpu_.special[address] |= peripheral.is_memory_at_times(address) ? kChangesItsWay : 0;
    }
    for (const uint8_t vector : peripheral.vectors()) {
        at_vector_[vector] = &peripheral;
    }
    all_.push_back(&peripheral);
}

// What one part of the chip has to tell another.
void Chip::join() {
    adc_->on_setup_changed([this](uint64_t cycle) {
        update_triggers(cycle);
        comparator_->inputs_changed(cycle); // the multiplexer feeds it, too
    });
    gpio_->on_int0([this](uint64_t cycle) { adc_->trigger(AdcTrigger::Int0, cycle); });
    for (unsigned i : {0u, 1u}) {
        timers_[i]->on_flags([this](uint64_t cycle) {
            for (unsigned source = 3; source <= 7; source++) {
                adc_->trigger(static_cast<AdcTrigger>(source), cycle);
            }
        });
    }
    gpio_->on_line_changed([this](PinId pin) { line_changed(pin); });
    comparator_->on_setup(
        [this](uint64_t cycle) { timers_[1]->capture_from_comparator(comparator_->captures(), cycle); });
    comparator_->on_change([this](bool level, uint64_t cycle) {
        if (comparator_->captures()) {
            timers_[1]->capture_edge(level, cycle);
        }
        adc_->trigger(AdcTrigger::Comparator, cycle);
    });
}

// The timers tell of the one flag that starts conversions, if any does.
void Chip::update_triggers(uint64_t cycle) {
    const auto mask = [this](AdcTrigger one, uint8_t its, AdcTrigger other, uint8_t others) {
        return static_cast<uint8_t>((adc_->is_triggered_by(one) ? its : 0) |
                                    (adc_->is_triggered_by(other) ? others : 0));
    };
    const uint8_t capture = adc_->is_triggered_by(AdcTrigger::Timer1Capture) ? kFlagCapture : 0;
    timers_[0]->tell_of_flags(
        mask(AdcTrigger::Timer0CompareA, kFlagCompareA, AdcTrigger::Timer0Overflow, kFlagOverflow), cycle);
    timers_[1]->tell_of_flags(capture | mask(AdcTrigger::Timer1CompareB, kFlagCompareA << 1,
                                             AdcTrigger::Timer1Overflow, kFlagOverflow),
                              cycle);
}

// --- the core's bus ---

uint8_t Chip::read(uint16_t address, uint64_t cycle) {
    Peripheral* peripheral = at_address_[address];
    return peripheral == nullptr ? cpu_.data[address] : peripheral->read(address, cycle);
}

void Chip::write(uint16_t address, uint8_t value, uint64_t cycle) {
    value &= kRegisters.implemented[address];
    if (Peripheral* peripheral = at_address_[address]; peripheral != nullptr) {
        if (!peripheral->is_reduced()) {
            peripheral->write(address, value, cycle);
        }
    } else {
        write_system(address, value, cycle);
    }
}

void Chip::write_bit(uint16_t address, uint8_t mask, bool value, uint64_t cycle) {
    if (acts_by_ones(address)) {
        write(address, value ? mask : 0, cycle);
        return;
    }
    const uint8_t before = read(address, cycle);
    write(address, static_cast<uint8_t>(value ? before | mask : before & ~mask), cycle);
}

void Chip::write_system(uint16_t address, uint8_t value, uint64_t cycle) {
    if (address == kSpl || address == kSph) {
        write_stack_pointer(address, value, cycle);
        return;
    }
    if (address == kClkpr) {
        write_clock_prescaler(value, cycle);
        return;
    }
    if (address == kMcucr) {
        write_control(value, cycle);
        return;
    }
    if (address == kMcusr) { // its flags can be cleared only
        cpu_.data[kMcusr] &= value;
        return;
    }
    cpu_.data[address] = value;
    if (address == kSmcr) {
        cpu_.sleep_enabled = (value & kSleepEnable) != 0;
    } else if (address == kPrr0 || address == kPrr1) {
        update_clocks(cycle + 1);
    } else if (address == kGtccr) {
        synchronise_prescalers(value, cycle + 1);
    } else if (address == kDidr0 || address == kDidr2) { // ADC0 to 7, and 8 to 15
        gpio_->set_inputs_off(port_index(address == kDidr0 ? 'F' : 'K'), value);
    } else if (address == kDidr1) { // AIN0 and AIN1
        gpio_->set_inputs_off(port_index('E'), static_cast<uint8_t>(value << 2));
    } else if (const char* function = unmodelled_function(address, value); function != nullptr) {
        warnings_.once(function);
    }
}

// IVSEL can be changed within four cycles after IVCE was set alone; JTD when it is written twice within four.
void Chip::write_control(uint8_t value, uint64_t cycle) {
    const uint8_t before = cpu_.data[kMcucr];
    const bool movable = cycle <= vectors_movable_until_ && (value & kIvce) == 0;
    vectors_movable_until_ = (value & kIvce) != 0 ? cycle + kSequenceCycles : 0;
    const bool repeated = cycle <= jtag_changeable_until_ && ((value ^ jtag_wanted_) & kJtd) == 0;
    jtag_changeable_until_ = repeated ? 0 : cycle + kSequenceCycles;
    jtag_wanted_ = value & kJtd;
    const uint8_t kept = (movable ? 0 : kIvsel) | (repeated ? 0 : kJtd);
    cpu_.data[kMcucr] = static_cast<uint8_t>(((value & ~kept) | (before & kept)) & ~kIvce);
    cpu_.vector_base = (cpu_.data[kMcucr] & kIvsel) != 0 ? fuses_.boot_start() : 0;
    gpio_->set_pull_ups((value & kPud) == 0, cycle);
}

// Compilers write the high byte first, and the low byte at once after it.
void Chip::write_stack_pointer(uint16_t address, uint8_t value, uint64_t cycle) {
    constexpr uint64_t kTogether = 8;
    const uint16_t before = ops::pair(&cpu_, kSpl);
    cpu_.data[address] = value;
    if (address == kSph) {
        stack_before_ = before;
        stack_written_until_ = cycle + kTogether;
        return;
    }
    const uint16_t from = cycle <= stack_written_until_ ? stack_before_ : before;
    stack_written_until_ = 0;
    cpu_.stack_pointer_written(from, ops::pair(&cpu_, kSpl));
}

void Chip::synchronise_prescalers(uint8_t value, uint64_t cycle) {
    const auto restarts = [value](const Timer& timer) {
        return (value & (timer.has_own_prescaler() ? kPsrAsync : kPsrSync)) != 0;
    };
    for (auto& timer : timers_) {
        if (restarts(*timer)) {
            timer->prescaler_restarts(cycle);
        }
    }
    if ((value & kPsrSync) != 0) {
        prescaler_.restart(cycle);
    }
    if ((value & kPsrAsync) != 0) {
        own_prescaler_.restart(cycle);
    }
    for (auto& timer : timers_) {
        if (restarts(*timer)) {
            timer->prescaler_restarted();
        }
    }
    const bool held = (value & kTsm) != 0; // the resets stay as long as TSM does
    cpu_.data[kGtccr] = held ? value & (kTsm | kPsrSync | kPsrAsync) : 0;
    update_clocks(cycle);
}

} // namespace tilenca::avr
