// SPM: the boot section writes the flash, page by page.
#pragma once

#include "avr/fuses.h"
#include "avr/peripheral.h"

#include <memory>

namespace tilenca::avr {

constexpr uint32_t kPageBytes = 256;

class SelfProgramming : public Peripheral {
  public:
    static constexpr uint8_t kCalibration = 0x80; // of the internal oscillator; each chip has its own

    SelfProgramming(const Core& core, std::shared_ptr<Program>& program, Fuses& fuses);

    std::vector<uint16_t> registers() const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override;
    // To be called after the program has been replaced as a whole.
    void program_changed() { update_access(); }

    // The SPM instruction at a word of flash; returns its cycles.
    uint32_t execute(uint32_t word, uint64_t cycle, bool advance_z);
    bool has_changed_flash() const { return changed_; }
    void set_changed_flash(bool changed) { changed_ = changed; }
    // What LPM and ELPM at that word get where the core may not read the flash by itself.
    uint8_t read_flash(uint32_t word, uint32_t address);

  private:
    bool reads_row() const;
    uint8_t read_row(uint32_t address) const;
    bool refuses(uint32_t page);
    void write_lock();
    bool is_boot_section(uint32_t byte_address) const { return byte_address >= 2 * fuses_.boot_start(); }
    void start(uint8_t command, uint32_t z, uint64_t cycle);
    void change_page(uint32_t page, bool erase);
    void finish_command();
    void update_access();
    void update_requests();

    std::shared_ptr<Program>& program_; // shared with other chips until this one changes it
    Fuses& fuses_;
    uint8_t buffer_[kPageBytes];
    uint64_t armed_until_ = 0;
    bool busy_ = false;    // with a page
    bool changed_ = false; // the flash is no longer the image's
};

} // namespace tilenca::avr
