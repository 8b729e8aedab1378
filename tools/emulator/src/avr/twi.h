// The two-wire interface (I2C) as master of an empty bus: no address is acknowledged.
#pragma once

#include "avr/peripheral.h"

namespace tilenca::avr {

class Twi : public Peripheral {
  public:
    explicit Twi(const Core& core) : Peripheral(core) {}

    std::vector<uint16_t> registers() const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override;

  private:
    enum class Phase : uint8_t { Idle, Started, Writing, Reading };
    friend constexpr Phase last_of(Phase) { return Phase::Reading; }

    void clock_stops(uint64_t cycle) override;
    void clock_starts(uint64_t cycle, uint64_t stood) override;
    void go_on(uint8_t control, uint64_t cycle);
    void set_status(uint8_t code);
    uint64_t bit_cycles() const;
    void update_requests();

    Phase phase_ = Phase::Idle;
    uint8_t coming_ = 0; // the status the action under way ends with; 0: a stop
};

} // namespace tilenca::avr
