// What happens next around the core, and when.
#pragma once

#include "avr/cpu.h"

#include <array>
#include <cstdint>

namespace tilenca::avr {

// One place in the schedule per thing that can happen; the order decides among equal times.
enum class Slot : uint8_t {
    Lines,
    Timer0,
    Timer1,
    Timer2,
    Timer3,
    Timer4,
    Timer5,
    Receive0,
    Receive1,
    Receive2,
    Receive3,
    Transmit0,
    Transmit1,
    Transmit2,
    Transmit3,
    Eeprom,
    Adc,
    Watchdog,
    ProgramMemory,
    Count
};

constexpr size_t kSlots = static_cast<size_t>(Slot::Count);

constexpr Slot operator+(Slot slot, unsigned offset) {
    return static_cast<Slot>(static_cast<unsigned>(slot) + offset);
}

// When what happens next. At most one event per slot; scheduling again moves it.
class Schedule {
  public:
    explicit Schedule(Cpu& cpu) : cpu_(cpu) { due_.fill(kNever); }

    void set(Slot slot, uint64_t cycle) {
        due_[static_cast<size_t>(slot)] = cycle;
        if (cycle < cpu_.limit) {
            cpu_.limit = cycle;
        }
        next_known_ = false;
    }
    void cancel(Slot slot) { set(slot, kNever); }
    uint64_t due(Slot slot) const { return due_[static_cast<size_t>(slot)]; }

    // The earliest slot and its time.
    Slot next(uint64_t* cycle) {
        if (!next_known_) {
            find_next();
        }
        *cycle = due_[next_];
        return static_cast<Slot>(next_);
    }

  private:
    void find_next() {
        next_ = 0;
        for (size_t i = 1; i < kSlots; i++) {
            if (due_[i] < due_[next_]) {
                next_ = i;
            }
        }
        next_known_ = true;
    }

    Cpu& cpu_;
    std::array<uint64_t, kSlots> due_;
    size_t next_ = 0;
    bool next_known_ = false;
};

} // namespace tilenca::avr
