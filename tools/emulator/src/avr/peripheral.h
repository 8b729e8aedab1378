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
