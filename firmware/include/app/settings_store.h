// Keeps the settings in EEPROM, in two blocks of each kind: docs/PROTOCOL.md section 5. The second block is
// written first, so one of both is whole whenever the power fails.
//
// `Eeprom` is any memory whose bytes are written slowly and one at a time. It has
//
// - bool busy(): a byte is still being written, perhaps since before a reset
// - uint8_t read(uint8_t address): only while not busy()
// - void write(uint8_t address, uint8_t byte): begins to write a byte; only while not busy()
#pragma once

#include <stdint.h>

#include "app/settings.h"

namespace tilenca {

template <class Eeprom>
class SettingsStore {
  public:
    enum class Found : uint8_t { Nothing, Damage, Settings };

    explicit SettingsStore(Eeprom eeprom = Eeprom()) : eeprom_(eeprom) {}

    // Reads the settings at the start; leaves them unchanged if there are none. If a byte was being written
    // when a reset came, waits for its end, 3.4 ms at most. If another block is still to be mended, waits
    // for that, too.
    Found load(Block kind, Settings* settings);

    // Begins to write settings into both blocks of a kind; writing() does it.
    void write(Block kind, const Settings& settings) {
        write_settings(kind, settings, block_);
        start_ = start_of(kind);
        written_ = 0;
    }

    // Goes on writing if the memory is ready for it, without waiting. False when all is written.
    bool writing();

    // Whether both blocks are what write() was given. Only while not writing().
    bool verify();

  private:
    static constexpr uint8_t kBytes = 2 * kSettingsSize;

    static uint8_t start_of(Block kind) { return kind == Block::Marking ? kBytes : 0; }
    void read(uint8_t address, uint8_t (&block)[kSettingsSize]);

    Eeprom eeprom_;
    uint8_t start_ = 0; // address of the first block
    uint8_t block_[kSettingsSize] = {};
    uint8_t written_ = kBytes; // of both blocks, the second one first
};

template <class Eeprom>
typename SettingsStore<Eeprom>::Found SettingsStore<Eeprom>::load(Block kind, Settings* settings) {
    while (writing()) {
    }
    uint8_t first[kSettingsSize], second[kSettingsSize];
    read(start_of(kind), first);
    read(start_of(kind) + kSettingsSize, second);
    if (parse_settings(kind, first, settings)) {
        return Found::Settings;
    }
    if (parse_settings(kind, second, settings)) {
        write(kind,
              *settings); // the next change writes the second block first: the first must be whole by then
        return Found::Settings;
    }
    return is_blank(first) ? Found::Nothing : Found::Damage;
}

template <class Eeprom>
bool SettingsStore<Eeprom>::writing() {
    if (eeprom_.busy()) {
        return true;
    }
    while (written_ < kBytes) {
        const bool second = written_ < kSettingsSize;
        const uint8_t byte = block_[second ? written_ : written_ - kSettingsSize];
        const uint8_t address = start_ + (second ? kSettingsSize + written_ : written_ - kSettingsSize);
        ++written_;
        if (eeprom_.read(address) != byte) {
            eeprom_.write(address, byte);
            return true;
        }
    }
    return false;
}

template <class Eeprom>
bool SettingsStore<Eeprom>::verify() {
    for (uint8_t i = 0; i < kBytes; ++i) {
        if (eeprom_.read(start_ + i) != block_[i % kSettingsSize]) {
            return false;
        }
    }
    return true;
}

template <class Eeprom>
void SettingsStore<Eeprom>::read(uint8_t address, uint8_t (&block)[kSettingsSize]) {
    for (uint8_t& byte : block) {
        byte = eeprom_.read(address++);
    }
}

} // namespace tilenca
