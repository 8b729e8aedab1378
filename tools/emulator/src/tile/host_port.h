// The computer's end of a tile's USB serial: 8N1 at an exact baud rate, whatever the tile's clock.
//
// Its program is taken to have opened the port at the rate the tile's own program has in mind.
#pragma once

#include "avr/gpio.h"
#include "tile/serial_receiver.h"

#include <functional>

namespace tilenca {

class HostPort : public avr::EdgeListener {
  public:
    using Byte = SerialReceiver::Byte;
    // Puts a level on the tile's receiving wire at a time in ticks.
    using Drive = std::function<void(double ticks, bool level)>;

    HostPort(const Clock& clock, Drive drive) : clock_(clock), drive_(std::move(drive)) {}

    void follow(double bit_ticks) { receiver_.follow(bit_ticks); }
    void send(uint8_t byte) { to_send_.push_back(byte); }
    bool all_sent() const { return to_send_.empty(); }
    // Takes what has come in by then, in ticks.
    void receive_until(double end) { receiver_.receive_until(end); }
    // Drives the line for some time after `end`, up to which the tile has run.
    void send_until(double end);
    std::deque<Byte>& received() { return receiver_.received(); }

    void edge(avr::PinId pin, uint64_t cycle, bool level, bool open) override;
    void state(avr::Archive& archive);

  private:
    const Clock& clock_;
    Drive drive_;
    SerialReceiver receiver_;
    std::deque<uint8_t> to_send_;
    double line_free_ = 0;
};

} // namespace tilenca
