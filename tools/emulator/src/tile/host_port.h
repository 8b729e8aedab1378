// The computer's end of a tile's USB serial: 8N1 at an exact baud rate, whatever the tile's clock.
//
// Its program is taken to have opened the port at the rate the tile's own program has in mind.
#pragma once

#include "avr/frame_reader.h"
#include "avr/gpio.h"
#include "tile/clock.h"

#include <deque>
#include <functional>

namespace tilenca {

class HostPort : public avr::EdgeListener {
  public:
    struct Byte {
        double ticks; // when its stop bit was seen
        uint8_t value;
    };
    // Puts a level on the tile's receiving wire at a time in ticks.
    using Drive = std::function<void(double ticks, bool level)>;

    HostPort(const Clock& clock, Drive drive) : clock_(clock), drive_(std::move(drive)) {}

    // From now on at the rate a tile means whose bits take that many of its cycles; 0: it says nothing.
    void follow(uint32_t bit_cycles);
    void send(uint8_t byte) { to_send_.push_back(byte); }
    bool all_sent() const { return to_send_.empty(); }
    // Takes part in the time up to `end`, in ticks.
    void run_until(double end);
    std::deque<Byte>& received() { return received_; }

    void edge(avr::PinId pin, uint64_t cycle, bool level) override;

  private:
    double bit_ticks() const { return kTicksPerSecond / baud_; }
    void send_until(double end);
    void receive_until(double end);

    const Clock& clock_;
    Drive drive_;
    uint32_t followed_bit_cycles_ = 0;
    double baud_ = 115200;
    std::deque<uint8_t> to_send_;
    double line_free_ = 0;
    avr::Line line_; // in ticks
    double listening_from_ = 0;
    std::deque<Byte> received_;
};

} // namespace tilenca
