// The analog comparator: its two inputs, the bandgap and the ADC's multiplexer, interrupt, timer 1's capture.
#pragma once

#include "avr/adc.h"

namespace tilenca::avr {

class Comparator : public Peripheral {
  public:
    Comparator(const Core& core, Adc& adc) : Peripheral(core), adc_(adc) {}

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override;

    // The voltages at AIN0 and AIN1, in 1024ths of the supply. To be called, too, after the ADC's inputs
    // changed.
    void set_inputs(uint16_t ain0, uint16_t ain1, uint64_t cycle);
    void inputs_changed(uint64_t cycle);
    uint16_t input(unsigned which) const { return inputs_[which & 1]; }

    bool captures() const;
    // Told of every change of the output; and whenever it may have been joined to timer 1's capture unit.
    void on_change(std::function<void(bool level, uint64_t cycle)> call) { changed_ = std::move(call); }
    void on_setup(std::function<void(uint64_t cycle)> call) { setup_ = std::move(call); }

  private:
    bool compare() const;
    void update_requests();

    Adc& adc_;
    std::array<uint16_t, 2> inputs_{};
    bool output_ = false;
    std::function<void(bool, uint64_t)> changed_ = [](bool, uint64_t) {};
    std::function<void(uint64_t)> setup_ = [](uint64_t) {};
};

} // namespace tilenca::avr
