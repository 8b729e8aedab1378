// A receiver of a serial line at an exact baud rate: 8N1, in ticks, whatever the sender's clock.
#pragma once

#include "avr/frame_reader.h"
#include "tile/clock.h"

#include <algorithm>
#include <deque>

namespace tilenca {

class SerialReceiver {
  public:
    struct Byte {
        double ticks; // when its stop bit was seen
        uint8_t value;
        bool framing_error;
        void state(avr::Archive& archive) { archive(ticks, value, framing_error); }
    };

    void set_baud(double baud) { baud_ = baud; }
    // Sets the rate from the length of a bit; 0: the rate is not known.
    void follow(double bit_ticks);
    double bit_ticks() const { return kTicksPerSecond / baud_; }
    // A later call with an earlier time takes back what was said after it.
    void edge(double ticks, bool level) {
        line_.push(static_cast<uint64_t>(std::ceil(std::max(ticks, 0.0))), avr::drive_of(level));
    }
    // Reads all frames that were over by then.
    void receive_until(double end);
    std::deque<Byte>& received() { return received_; }
    void state(avr::Archive& archive);

  private:
    double baud_ = 115200, followed_bit_ticks_ = 0;
    avr::Line line_; // in ticks
    double listening_from_ = 0;
    std::deque<Byte> received_;
};

} // namespace tilenca
