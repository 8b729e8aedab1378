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

    // The SPM instruction at a word of flash; returns its cycles.
    uint32_t execute(uint32_t word, uint64_t cycle, bool advance_z);
    // What LPM and ELPM get while the core may not read the flash by itself.
    uint8_t read_flash(uint32_t address);

  private:
    bool reads_row() const;
    void start(uint8_t command, uint32_t z, uint64_t cycle);
    void change_page(uint32_t page, bool erase);
    void finish_command();
    void update_access();
    void update_requests();

    std::shared_ptr<Program>& program_; // shared with other chips until this one changes it
    uint8_t buffer_[kPageBytes];
    uint64_t armed_until_ = 0;
    bool busy_ = false; // with a page
};

} // namespace tilenca::avr
