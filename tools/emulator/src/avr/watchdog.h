// The watchdog: its own 128 kHz clock, timed changes, interrupt and reset.
#pragma once

#include "avr/fuses.h"
#include "avr/peripheral.h"

namespace tilenca::avr {

class Watchdog : public Peripheral {
  public:
    Watchdog(const Core& core, const Fuses& fuses) : Peripheral(core), fuses_(fuses) {}

    std::vector<uint16_t> registers() const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    bool reads_as_stored(uint16_t) const override { return true; }
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override {
        archive(changeable_until_, wants_reset_, error_);
        archive.require(std::abs(error_) <= 0.5 && !wants_reset_, "its watchdog is none");
    }

    // Its clock runs faster by that share, or slower.
    void set_error(double error) { error_ = error; }
    // Cycles of the CPU's clock that so many ticks of its own take.
    uint64_t cycles(uint64_t ticks) const;
    // WDR: counts from zero again.
    void restart(uint64_t cycle);
    // Set once its time ran out with reset enabled; the chip then resets.
    bool wants_reset() const { return wants_reset_; }
    // After a watchdog reset it stays on, at its shortest time, until WDRF is cleared; with WDTON for ever.
    void force_on(uint64_t cycle);

  private:
    bool is_on() const;
    void update_requests();

    const Fuses& fuses_;
    uint64_t changeable_until_ = 0;
    bool wants_reset_ = false;
    double error_ = 0;
};

} // namespace tilenca::avr
