// The analog-to-digital converter: conversion times, all 16 channels and their differences, triggers, noise.
#pragma once

#include "avr/peripheral.h"
#include "avr/random.h"

#include <array>
#include <functional>

namespace tilenca::avr {

// What can start a conversion by itself: ADTS in ADCSRB.
enum class AdcTrigger : uint8_t {
    FreeRunning,
    Comparator,
    Int0,
    Timer0CompareA,
    Timer0Overflow,
    Timer1CompareB,
    Timer1Overflow,
    Timer1Capture
};

class Adc : public Peripheral {
  public:
    explicit Adc(const Core& core) : Peripheral(core) {}

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    bool reads_as_stored(uint16_t address) const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override;

    // What a channel converts to, 0..1023.
    void set_input(unsigned channel, uint16_t value) { inputs_[channel % 16] = value & 0x3FF; }
    uint16_t input(unsigned channel) const { return inputs_[channel % 16]; }
    // The supply, which is the reference, too: inputs above are shares of it, and the bandgap's 1.1 V are
    // not.
    void set_supply(double volts) { supply_v_ = volts; }
    // What the bandgap converts to.
    double bandgap() const;
    // Every conversion is off by a normal deviate of this deviation, in units of the result's lowest bit.
    void set_noise(double deviation, uint64_t seed);

    // Called whenever the event that starts conversions may have changed, or the channel.
    void on_setup_changed(std::function<void(uint64_t cycle)> call) { setup_changed_ = std::move(call); }
    bool is_triggered_by(AdcTrigger source) const;
    void trigger(AdcTrigger source, uint64_t cycle);
    // Going to sleep in noise reduction mode starts a conversion.
    void start_quietly(uint64_t cycle);

  private:
    void clock_stops(uint64_t cycle) override;
    void clock_starts(uint64_t cycle, uint64_t stood) override;
    void write_control(uint8_t value, uint64_t cycle);
    void begin(uint64_t cycle);
    void show_result();
    unsigned divisor() const;
    double selected() const;
    double difference(unsigned mux) const;
    void update_requests();

    std::array<uint16_t, 16> inputs_{};
    double supply_v_ = 5;
    double noise_ = 0;
    Random random_;
    bool warm_ = false;       // the first conversion after switching on takes longer
    bool by_trigger_ = false; // the conversion under way was started by an event
    bool is_difference_ = false;
    bool held_ = false; // ADCL has been read: the result stays until ADCH has
    double sampled_ = 0;
    uint16_t result_ = 0;
    uint64_t origin_ = 0; // the prescaler counts from here
    std::function<void(uint64_t)> setup_changed_ = [](uint64_t) {};
};

} // namespace tilenca::avr
