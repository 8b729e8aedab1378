// What falls due around the core, and what the core asks of it.
#include "avr/chip.h"

#include <cstdio>

namespace tilenca::avr {

Peripheral& Chip::find_at_slot(Slot slot) {
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
    case Slot::Spi:
        return *spi_;
    case Slot::Twi:
        return *twi_;
    default:
        return *gpio_;
    }
}

uint64_t Chip::serve_events(uint64_t cycle) {
    uint64_t due = 0;
    for (Slot slot = schedule_.next(&due); due <= cycle; slot = schedule_.next(&due)) {
        at_slot_[static_cast<size_t>(slot)]->on_event(slot, due);
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

uint8_t Chip::read_program_memory(uint32_t word, uint32_t address) {
    return self_programming_->read_flash(word, address);
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

} // namespace tilenca::avr
