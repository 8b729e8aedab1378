// What every part around the core is built from: registers, events, interrupts, and the notice board for
// warnings.
#pragma once

#include "avr/schedule.h"

#include <cstdint>
#include <set>
#include <string>
#include <vector>

namespace tilenca::avr {

// Things done to the chip that it does not model, each told once.
class Warnings {
  public:
    void once(const std::string& what) {
        if (said_.insert(what).second) {
            list_.push_back(what);
        }
    }
    const std::vector<std::string>& list() const { return list_; }
    void state(Archive& archive) {
        archive(list_);
        said_ = {list_.begin(), list_.end()};
    }

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
    // Whether reading that register is reading its stored byte: then nobody needs to ask.
    virtual bool reads_as_stored(uint16_t /*address*/) const { return false; }
    // Whether there are times when it is no more than memory: its part of the chip then says so to the core.
    virtual bool is_memory_at_times(uint16_t /*address*/) const { return false; }
    virtual void on_event(Slot /*slot*/, uint64_t /*cycle*/) {}
    virtual std::vector<uint8_t> vectors() const { return {}; }
    virtual void interrupt_taken(uint8_t /*vector*/) {}
    // All registers have their initial values already.
    virtual void reset(uint64_t cycle) = 0;
    // What it holds besides its registers, which lie in data memory.
    virtual void state(Archive& archive) = 0;

    // Its clock stands while the chip sleeps deeply, or saves power.
    void stop_clock(uint64_t cycle) {
        if (!stands_) {
            clock_stops(cycle);
            stands_ = true;
            stands_since_ = cycle;
        }
    }
    void start_clock(uint64_t cycle) {
        if (stands_) {
            stands_ = false;
            clock_starts(cycle, cycle - stands_since_);
        }
    }
    // Power reduction has taken its clock: its registers cannot be written (data sheet, section 11.8).
    void set_reduced(bool reduced) { reduced_ = reduced; }
    bool is_reduced() const { return reduced_; }
    void clock_state(Archive& archive) { archive(stands_, stands_since_, reduced_); }

  protected:
    virtual void clock_stops(uint64_t /*cycle*/) {}
    virtual void clock_starts(uint64_t /*cycle*/, uint64_t /*stood*/) {}
    bool clock_stands() const { return stands_; }
    // The stored bytes of registers lie in data memory, like those of registers nobody answers for.
    uint8_t& byte(uint16_t address) const { return core_.cpu.data[address]; }

    Core core_;

  private:
    bool stands_ = false, reduced_ = false;
    uint64_t stands_since_ = 0;
};

} // namespace tilenca::avr
