// The analog-to-digital converter: conversion times, all 16 channels, interrupt, free running.
#pragma once

#include "avr/peripheral.h"

#include <array>

namespace tilenca::avr {

class Adc : public Peripheral {
  public:
    explicit Adc(const Core& core) : Peripheral(core) {}

    std::vector<uint16_t> registers() const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;

    // What a channel converts to, 0..1023.
    void set_input(unsigned channel, uint16_t value) { inputs_[channel % 16] = value & 0x3FF; }

  private:
    void write_control(uint8_t value, uint64_t cycle);
    void start(uint64_t cycle, unsigned adc_clocks);
    uint16_t selected() const;
    void update_requests();

    std::array<uint16_t, 16> inputs_{};
    bool warm_ = false; // the first conversion after switching on takes longer
};

} // namespace tilenca::avr
