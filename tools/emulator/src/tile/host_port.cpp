#include "tile/host_port.h"

#include <algorithm>

namespace tilenca {

namespace {

constexpr avr::FrameFormat kFormat{8, 0, 1};
constexpr double kMarginTicks = 64; // the tile's last instruction may already have passed the end of its turn
// So far ahead the line is driven: longer than any turn, so that bytes follow each other without a pause.
constexpr double kAheadTicks = 4096;

} // namespace

// The bridge has a pull-up of its own.
void HostPort::edge(avr::PinId, uint64_t cycle, bool level, bool open) {
    receiver_.edge(clock_.to_ticks(cycle), level || open);
}

void HostPort::send_until(double end) {
    const double bit_ticks = receiver_.bit_ticks();
    while (!to_send_.empty() && line_free_ < end + kAheadTicks) {
        const uint16_t bits = kFormat.encode(to_send_.front());
        to_send_.pop_front();
        line_free_ = std::max(line_free_, end + kMarginTicks);
        for (unsigned i = 0; i < kFormat.sent_bits(); i++) {
            drive_(line_free_ + i * bit_ticks, (bits >> i & 1) != 0);
        }
        line_free_ += kFormat.sent_bits() * bit_ticks;
    }
}

void HostPort::state(avr::Archive& archive) {
    std::vector<uint8_t> bytes(to_send_.begin(), to_send_.end());
    archive(receiver_, bytes, line_free_);
    to_send_.assign(bytes.begin(), bytes.end());
}

} // namespace tilenca
