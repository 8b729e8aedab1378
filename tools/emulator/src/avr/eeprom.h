// The 4 KiB EEPROM with its write protocol and write time.
#pragma once

#include "avr/peripheral.h"

namespace tilenca::avr {

constexpr uint16_t kEepromBytes = 4096;

class Eeprom : public Peripheral {
  public:
    explicit Eeprom(const Core& core) : Peripheral(core), memory_(kEepromBytes, 0xFF) {}

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override { archive(memory_, armed_until_, busy_); }

    std::vector<uint8_t>& memory() { return memory_; }

  private:
    void start_write(uint64_t cycle);
    void update_requests();

    std::vector<uint8_t> memory_;
    uint64_t armed_until_ = 0; // EEPE counts only within four cycles of EEMPE
    bool busy_ = false;
};

} // namespace tilenca::avr
