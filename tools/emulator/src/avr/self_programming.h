// SPM: the boot section writes the flash, page by page.
#pragma once

#include "avr/peripheral.h"

#include <memory>

namespace tilenca::avr {

constexpr uint32_t kPageBytes = 256;
constexpr uint32_t kBootStartWord = 0x1F000; // the largest boot section, 8 KiB: the Mega's fuses

class SelfProgramming : public Peripheral {
  public:
    SelfProgramming(const Core& core, std::shared_ptr<Program>& program);

    std::vector<uint16_t> registers() const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void reset(uint64_t cycle) override;

    // The SPM instruction; returns its cycles.
    uint32_t execute(uint64_t cycle, bool advance_z);

  private:
    void change_page(uint32_t page, bool erase);
    void update_requests();

    std::shared_ptr<Program>& program_; // shared with other chips until this one changes it
    uint8_t buffer_[kPageBytes];
    uint64_t armed_until_ = 0;
};

} // namespace tilenca::avr
