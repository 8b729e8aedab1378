// One of the six timers: its registers, its clock, its interrupts and its pins around a Counter.
//
// The counter is brought up to date only when somebody looks, or when an enabled interrupt falls due.
#pragma once

#include "avr/counter.h"
#include "avr/gpio.h"
#include "avr/prescaler.h"

#include <functional>

namespace tilenca::avr {

class Timer final : public Peripheral, public PinSource, private PinWatcher {
  public:
    Timer(const Core& core, Gpio& gpio, Prescaler& prescaler, unsigned number);

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    bool reads_as_stored(uint16_t address) const override;
    bool is_memory_at_times(uint16_t address) const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;
    bool pin_level(PinId pin, uint64_t cycle) override;
    void observers_changed() override {
        look_for_observers();
        reschedule();
    }
    void state(Archive& archive) override;

    // Calls `call` whenever one of the flags in `mask` is set.
    void on_flags(std::function<void(uint64_t cycle)> call) { on_flags_ = std::move(call); }
    void tell_of_flags(uint8_t mask, uint64_t cycle);
    // The analog comparator takes the place of the capture pin, or gives it back.
    void capture_from_comparator(bool on, uint64_t cycle);
    void capture_edge(bool level, uint64_t cycle);

    // Share of time a pin is high, if this timer drives it; otherwise -1.
    double duty(PinId pin, uint64_t cycle);
    // Its prescaler is about to start again, or has just done so.
    void prescaler_restarts(uint64_t cycle) { sync(cycle); }
    void prescaler_restarted() { reschedule(); }
    bool has_own_prescaler() const { return number_ == 2; }
    // Registers that were memory go through the bus again.
    void take_back();

  private:
    void clock_stops(uint64_t cycle) override;
    void clock_starts(uint64_t cycle, uint64_t stood) override;
    void pin_changed(PinId pin, uint64_t cycle, bool level) override;
    void capture(uint64_t cycle);
    void watch_inputs(uint64_t cycle);
    bool captures() const;
    void look_for_observers();
    void show_outputs(uint64_t cycle);
    bool is_wide() const { return number_ == 1 || number_ >= 3; }
    unsigned channels() const { return is_wide() ? 3 : 2; }
    uint16_t control_a() const { return base_; }
    uint16_t control_b() const { return static_cast<uint16_t>(base_ + 1); }
    void sync(uint64_t cycle);
    void advance(uint64_t ticks, uint64_t cycle);
    uint64_t tick_index(uint64_t cycle) const { return prescaler_.count(cycle) >> shift_; }
    void write_control(uint16_t address, uint8_t value, uint64_t cycle);
    void write_value(unsigned offset, uint8_t value);
    unsigned first_compare() const;
    void note_plain();
    void write_plainly(unsigned offset, uint8_t value);
    void lend(unsigned offset);
    bool compare_matters(unsigned offset) const;
    void set_compare(unsigned channel, uint16_t value);
    uint8_t read_value(unsigned offset);
    void write_wide(unsigned offset, uint16_t value);
    void apply_mode();
    void apply_outputs(uint64_t cycle);
    void apply_clock(uint64_t cycle);
    void update_requests();
    void set_divisor(uint32_t divisor);
    void reschedule();

    Gpio& gpio_;
    Prescaler& prescaler_;
    unsigned number_;
    uint16_t base_, flag_register_, mask_register_;
    uint8_t first_vector_; // of compare A
    Slot slot_;
    Counter counter_;
    std::array<PinId, 3> pins_{};
    std::array<bool, 3> driving_{};
    bool is_observed_ = false; // somebody must know when an output changes
    uint8_t temp_ = 0;         // the byte a 16-bit access leaves for its second half
    uint32_t divisor_ = 0;     // 0: the clock is stopped
    uint8_t shift_ = 0;        // the divisor's logarithm
    uint64_t synced_ = 0;
    uint8_t external_clock_ = 0; // 6: falling edges of the T pin, 7: rising ones, 0: none
    bool comparator_captures_ = false;
    uint64_t capture_due_ = kNever; // an edge that the noise canceller has not let pass yet
    uint8_t told_flags_ = 0;
    uint8_t plain_ = 0; // a bit per register, from TCCRnA on: no more than its value comes of a write
    uint8_t lent_ = 0;  // a bit per register: it is memory, and the counter does not know its value
    std::function<void(uint64_t)> on_flags_ = [](uint64_t) {};
};

} // namespace tilenca::avr
