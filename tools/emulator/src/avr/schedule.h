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
    Spi,
    Twi,
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
        const auto index = static_cast<unsigned>(slot);
        if (due_[index] == cycle) {
            return;
        }
        const uint32_t bit = 1u << index;
        due_[index] = cycle;
        set_ = cycle == kNever ? set_ & ~bit : set_ | bit;
        if (cycle < cpu_.limit) {
            cpu_.limit = cycle;
        }
        if (index == next_) {
            forget_next();
        } else if (cpu_.event_due != 0 && (stopped_ & bit) == 0 && comes_first(cycle, index)) {
            next_ = index;
            cpu_.event_due = cycle;
        }
    }
    void cancel(Slot slot) { set(slot, kNever); }
    uint64_t due(Slot slot) const { return due_[static_cast<size_t>(slot)]; }
    // What is due in that slot waits until its clock runs again, and then as much longer as it stood.
    void stop(Slot slot) {
        stopped_ |= 1u << static_cast<unsigned>(slot);
        forget_next();
    }
    void go_on(Slot slot, uint64_t stood) {
        stopped_ &= ~(1u << static_cast<unsigned>(slot));
        const uint64_t was = due(slot);
        set(slot, was == kNever ? kNever : was + stood);
        forget_next();
        cpu_.end_soon();
    }
    void state(Archive& archive) {
        archive(due_, stopped_);
        archive.require(stopped_ >> kSlots == 0, "it has more events than there are");
        set_ = 0;
        for (size_t i = 0; i < kSlots; i++) {
            set_ |= uint32_t{due_[i] != kNever} << i;
        }
        forget_next();
    }

    // The earliest slot and its time.
    Slot next(uint64_t* cycle) {
        if (cpu_.event_due == 0) {
            find_next();
        }
        *cycle = cpu_.event_due;
        return static_cast<Slot>(next_);
    }

  private:
    void forget_next() { cpu_.event_due = 0; }
    bool comes_first(uint64_t cycle, unsigned index) const {
        return cycle < cpu_.event_due || (cycle == cpu_.event_due && index < next_);
    }

    void find_next() {
        next_ = 0;
        cpu_.event_due = kNever;
        for (uint32_t slots = set_ & ~stopped_; slots != 0; slots &= slots - 1) {
            const auto i = static_cast<unsigned>(__builtin_ctz(slots));
            const bool is_sooner = due_[i] < cpu_.event_due; // no branch: nobody could foretell it
            next_ = is_sooner ? i : next_;
            cpu_.event_due = is_sooner ? due_[i] : cpu_.event_due;
        }
    }

    Cpu& cpu_;
    std::array<uint64_t, kSlots> due_;
    unsigned next_ = 0;
    uint32_t stopped_ = 0; // a bit per slot
    uint32_t set_ = 0;     // slots that have a time
};

} // namespace tilenca::avr
