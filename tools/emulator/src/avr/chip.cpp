#include "avr/chip.h"

#include "avr/unmodelled.h"

#include <cstdio>
#include <cstring>

namespace tilenca::avr {

namespace {

constexpr uint16_t kPinFirst = 0x20, kFlagsFirst = 0x35, kFlagsLast = 0x3C, kGtccr = 0x43, kSmcr = 0x53;
constexpr uint16_t kMcusr = 0x54, kMcucr = 0x55, kSreg = 0x5F;
constexpr uint8_t kIvce = 1, kIvsel = 2;
constexpr uint8_t kPsrSync = 1, kPsrAsync = 2, kTsm = 0x80;
constexpr uint8_t kSleepEnable = 1, kSleepMode = 0x0E;

// Registers in which a written one acts on that bit alone, and a zero does nothing: flags, and PIN's toggles.
bool acts_by_ones(uint16_t address) {
    const bool is_pin = address >= kPinFirst && address < kFlagsFirst - 1 && (address - kPinFirst) % 3 == 0;
    return is_pin || (address >= kFlagsFirst && address <= kFlagsLast);
}

} // namespace

Chip::Chip(std::shared_ptr<Program> program, const Fuses& fuses)
    : program_(std::move(program)), fuses_(fuses), schedule_(cpu_) {
    std::memset(cpu_.data, 0, sizeof cpu_.data);
    std::memset(cpu_.special, 0, sizeof cpu_.special);
    cpu_.bus = this;
    cpu_.use(*program_);
    const Core core{cpu_, schedule_, warnings_};
    gpio_ = std::make_unique<Gpio>(core);
    eeprom_ = std::make_unique<Eeprom>(core);
    adc_ = std::make_unique<Adc>(core);
    watchdog_ = std::make_unique<Watchdog>(core);
    self_programming_ = std::make_unique<SelfProgramming>(core, program_);
    for (unsigned i = 0; i < timers_.size(); i++) {
        timers_[i] = std::make_unique<Timer>(core, *gpio_, i);
        attach(*timers_[i]);
    }
    for (unsigned i = 0; i < usarts_.size(); i++) {
        usarts_[i] = std::make_unique<Usart>(core, *gpio_, i);
        attach(*usarts_[i]);
    }
    for (Peripheral* one :
         {static_cast<Peripheral*>(eeprom_.get()), static_cast<Peripheral*>(adc_.get()),
          static_cast<Peripheral*>(watchdog_.get()), static_cast<Peripheral*>(self_programming_.get()),
          static_cast<Peripheral*>(gpio_.get())}) {
        attach(*one);
    }
    for (uint16_t address = kIoStart; address < kSramStart; address++) {
        const bool system = address == kGtccr || address == kSmcr || address == kMcucr || address == kSreg;
        cpu_.special[address] = cpu_.special[address] || system || is_unmodelled(address);
    }
    reset(ResetCause::PowerOn);
}

Chip::~Chip() = default;

void Chip::attach(Peripheral& peripheral) {
    for (const uint16_t address : peripheral.registers()) {
        at_address_[address] = &peripheral;
        cpu_.special[address] = true;
    }
    for (const uint8_t vector : peripheral.vectors()) {
        at_vector_[vector] = &peripheral;
    }
    all_.push_back(&peripheral);
}

void Chip::reset(ResetCause cause) {
    const uint8_t causes = cause == ResetCause::PowerOn ? 0 : cpu_.data[kMcusr];
    cpu_.reset(fuses_.reset_to_boot ? kBootStartWord : 0);
    cpu_.data[kMcusr] = causes | static_cast<uint8_t>(cause);
    vectors_movable_until_ = 0;
    for (Peripheral* peripheral : all_) {
        peripheral->reset(cpu_.cycle);
    }
    if ((cpu_.data[kMcusr] & static_cast<uint8_t>(ResetCause::Watchdog)) != 0) {
        watchdog_->force_on(cpu_.cycle);
    }
}

// --- the core's bus ---

uint8_t Chip::read(uint16_t address, uint64_t cycle) {
    Peripheral* peripheral = at_address_[address];
    return peripheral == nullptr ? cpu_.data[address] : peripheral->read(address, cycle);
}

void Chip::write(uint16_t address, uint8_t value, uint64_t cycle) {
    if (Peripheral* peripheral = at_address_[address]; peripheral != nullptr) {
        peripheral->write(address, value, cycle);
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
    if (address == kMcucr) {
        const bool movable = cycle <= vectors_movable_until_;
        vectors_movable_until_ = (value & kIvce) != 0 ? cycle + 4 : 0;
        const uint8_t selected = (movable && (value & kIvce) == 0 ? value : cpu_.data[kMcucr]) & kIvsel;
        cpu_.data[kMcucr] = static_cast<uint8_t>((value & ~(kIvsel | kIvce)) | selected);
        cpu_.vector_base = selected != 0 ? kBootStartWord : 0;
        return;
    }
    cpu_.data[address] = value;
    if (address == kSmcr) {
        cpu_.sleep_enabled = (value & kSleepEnable) != 0;
        if ((value & kSleepEnable) != 0 && (value & kSleepMode) != 0) {
            warnings_.once("sleep modes deeper than idle: sleep like idle, all clocks run on");
        }
    } else if (address == kGtccr) {
        synchronise_prescalers(value, cycle);
    } else if (const char* function = unmodelled_function(address, value); function != nullptr) {
        warnings_.once(function);
    }
}

void Chip::synchronise_prescalers(uint8_t value, uint64_t cycle) {
    for (auto& timer : timers_) {
        if ((value & (timer->has_own_prescaler() ? kPsrAsync : kPsrSync)) != 0) {
            timer->restart_prescaler(cycle);
        }
    }
    cpu_.data[kGtccr] = value & kTsm;
    if ((value & kTsm) != 0) {
        warnings_.once("timer synchronisation (TSM): the prescalers are not held");
    }
}

Peripheral& Chip::at_slot(Slot slot) {
    const auto index = static_cast<unsigned>(slot);
    if (slot >= Slot::Timer0 && slot <= Slot::Timer5) {
        return *timers_[index - static_cast<unsigned>(Slot::Timer0)];
    }
    if (slot >= Slot::Receive0 && slot <= Slot::Transmit3) {
        return *usarts_[(index - static_cast<unsigned>(Slot::Receive0)) % 4];
    }
    switch (slot) {
    case Slot::Eeprom:
        return *eeprom_;
    case Slot::Adc:
        return *adc_;
    case Slot::Watchdog:
        return *watchdog_;
    case Slot::ProgramMemory:
        return *self_programming_;
    default:
        return *gpio_;
    }
}

uint64_t Chip::serve_events(uint64_t cycle) {
    uint64_t due = 0;
    for (Slot slot = schedule_.next(&due); due <= cycle; slot = schedule_.next(&due)) {
        at_slot(slot).on_event(slot, due);
        if (watchdog_->wants_reset()) {
            reset(ResetCause::Watchdog);
        }
    }
    return due;
}

void Chip::interrupt_taken(uint8_t vector, uint64_t) {
    if (at_vector_[vector] != nullptr) {
        at_vector_[vector]->interrupt_taken(vector);
    }
}

uint32_t Chip::store_program_memory(uint32_t word, uint64_t cycle, bool advance_z) {
    return self_programming_->execute(word, cycle, advance_z);
}

uint8_t Chip::read_program_memory(uint32_t address) {
    return self_programming_->read_flash(address);
}

void Chip::address_outside_memory(uint16_t address, bool write) {
    char text[80];
    if (!(write ? told_write_ : told_read_)) {
        std::snprintf(text, sizeof text, "%s beyond the end of SRAM (first: address 0x%04X)",
                      write ? "write" : "read", address);
        warnings_.once(text);
    }
    (write ? told_write_ : told_read_) = true;
}

// --- the outside ---

void Chip::push_edge(PinId pin, uint64_t cycle, bool level) {
    Line& line = *gpio_->line(pin);
    if (line.edges() > 32) {
        uint64_t needed = cpu_.cycle;
        for (auto& usart : usarts_) {
            const PinId receives = usart->receive_pin();
            if (receives.port == pin.port && receives.bit == pin.bit) {
                needed = usart->needs_line_from(needed);
            }
        }
        line.forget_before(needed);
    }
    line.push(cycle, level);
    gpio_->line_changed(pin);
    for (auto& usart : usarts_) {
        const PinId receives = usart->receive_pin();
        if (receives.port == pin.port && receives.bit == pin.bit) {
            usart->line_changed();
        }
    }
}

double Chip::duty(PinId pin) {
    if (!gpio_->is_output(pin)) {
        return 0;
    }
    for (auto& timer : timers_) {
        if (const double share = timer->duty(pin, cpu_.cycle); share >= 0) {
            return share;
        }
    }
    return gpio_->port_bit(pin) ? 1 : 0;
}

uint64_t Chip::wakes_at() {
    uint64_t due = 0;
    schedule_.next(&due);
    const bool idle = cpu_.asleep && !(cpu_.requests != 0 && cpu_.interrupts_on);
    return idle ? due : cpu_.cycle;
}

} // namespace tilenca::avr
