// The SPI as master: transfers with their time, waveforms on SCK and MOSI, and what MISO says.
#pragma once

#include "avr/gpio.h"

namespace tilenca::avr {

class Spi : public Peripheral {
  public:
    Spi(const Core& core, Gpio& gpio) : Peripheral(core), gpio_(gpio) {}

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;
    void state(Archive& archive) override;

    // Edges on MISO before this cycle matter no more.
    uint64_t needs_line_from(uint64_t now) const { return busy_ && started_ < now ? started_ : now; }
    // MISO gets what MOSI sends, as with a wire between the two.
    void set_loopback(bool on) { loopback_ = on; }

  private:
    void clock_stops(uint64_t cycle) override;
    void clock_starts(uint64_t cycle, uint64_t stood) override;
    void write_control(uint8_t value, uint64_t cycle);
    void start(uint8_t value, uint64_t cycle);
    void show(uint8_t value, uint64_t cycle);
    uint64_t bit_cycles() const;
    bool sends_first_bit_lowest() const;
    void update_requests();

    Gpio& gpio_;
    bool loopback_ = false;
    bool busy_ = false, done_ = false, collided_ = false, seen_ = false;
    uint64_t started_ = 0;
    uint8_t sending_ = 0, received_ = 0;
};

} // namespace tilenca::avr
