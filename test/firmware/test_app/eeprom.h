// An EEPROM that takes its time, can lose its power in the middle of any byte, and can have a worn byte.
#pragma once

#include <doctest/doctest.h>
#include <stdint.h>

#include <array>

#include "app/settings_store.h"

namespace tilenca {
namespace test {

// What is left of a byte during whose writing the power fails.
enum class Torn : uint8_t { Unchanged, Erased, HalfWritten, Whole };
constexpr Torn kTorn[] = {Torn::Unchanged, Torn::Erased, Torn::HalfWritten, Torn::Whole};

struct Memory {
    static constexpr int kNever = -1;

    Memory() { bytes.fill(0xFF); }

    bool has_power() const { return power_fails == kNever || writes <= power_fails; }

    std::array<uint8_t, 2 * kSettingsSize * kBlocks> bytes;
    int worn = kNever;        // the byte at this address keeps what it has
    int power_fails = kNever; // in the write after so many
    Torn torn = Torn::Erased; // the byte that is then being written
    int writes = 0;
    int busy_for = 0; // so many more questions
};

// What a SettingsStore takes. All copies are the same memory.
class Eeprom {
  public:
    explicit Eeprom(Memory* memory) : memory_(memory) {}

    bool busy() { return memory_->busy_for != 0 && --memory_->busy_for != 0; }

    uint8_t read(uint8_t address) const {
        REQUIRE(memory_->busy_for == 0);
        return memory_->bytes.at(address);
    }

    void write(uint8_t address, uint8_t byte) {
        REQUIRE(memory_->busy_for == 0);
        if (!memory_->has_power()) {
            return;
        }
        ++memory_->writes;
        memory_->busy_for = 3;
        uint8_t& kept = memory_->bytes.at(address);
        if (address != memory_->worn) {
            kept = memory_->has_power() ? byte : torn(kept, byte);
        }
    }

  private:
    uint8_t torn(uint8_t before, uint8_t after) const {
        switch (memory_->torn) {
        case Torn::Unchanged:
            return before;
        case Torn::Erased:
            return 0xFF;
        case Torn::HalfWritten:
            return after | 0x0F;
        case Torn::Whole:
            break;
        }
        return after;
    }

    Memory* memory_;
};

using Store = SettingsStore<Eeprom>;

// The memory that has these settings, and the marking if there is one, twice.
inline Memory memory_of(const Settings& settings) {
    uint8_t block[kSettingsSize];
    Memory memory;
    for (uint8_t kind = 0; kind < kBlocks; ++kind) {
        if (kind != 0 && settings.revision == 0) {
            break; // not marked: erased
        }
        write_settings(static_cast<Block>(kind), settings, block);
        for (size_t i = 0; i < 2 * kSettingsSize; ++i) {
            memory.bytes[2 * kSettingsSize * kind + i] = block[i % kSettingsSize];
        }
    }
    return memory;
}

} // namespace test
} // namespace tilenca
