// What every part around the core is built from: registers, events, interrupts, and the notice board for
// warnings.
#pragma once

#include "avr/cpu.h"

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

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
}; // clang-format keeps one per line otherwise

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

// Things done to the chip that it does not model, each told once.
class Warnings {
  public:
    void once(const std::string& what) {
        if (said_.insert(what).second) {
            list_.push_back(what);
        }
    }
    const std::vector<std::string>& list() const { return list_; }

  private:
    std::set<std::string> said_;
    std::vector<std::string> list_;
};

struct Core {
    Cpu& cpu;
    Schedule& schedule;
    Warnings& warnings;
};

class Peripheral {
  public:
    explicit Peripheral(const Core& core) : core_(core) {}
    Peripheral(const Peripheral&) = delete;
    Peripheral& operator=(const Peripheral&) = delete;
    virtual ~Peripheral() = default;

    // The addresses it answers for.
    virtual std::vector<uint16_t> registers() const = 0;
    virtual uint8_t read(uint16_t address, uint64_t /*cycle*/) { return byte(address); }
    virtual void write(uint16_t address, uint8_t value, uint64_t cycle) = 0;
    virtual void on_event(Slot /*slot*/, uint64_t /*cycle*/) {}
    virtual std::vector<uint8_t> vectors() const { return {}; }
    virtual void interrupt_taken(uint8_t /*vector*/) {}
    // All registers are zero already.
    virtual void reset(uint64_t cycle) = 0;

  protected:
    // The stored bytes of registers lie in data memory, like those of registers nobody answers for.
    uint8_t& byte(uint16_t address) const { return core_.cpu.data[address]; }

    Core core_;
};

} // namespace tilenca::avr
