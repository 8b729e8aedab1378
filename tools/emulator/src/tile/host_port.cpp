#include "tile/host_port.h"

#include <algorithm>

namespace tilenca {

namespace {

constexpr avr::FrameFormat kFormat{8, 0, 1};
constexpr unsigned kSamplesPerBit = 16;
// What terminal programs offer; a tile's divisor comes close to one of these, seldom to the point.
constexpr double kUsualBauds[] = {300,   600,   1200,  2400,   4800,   9600,   14400,  19200,   28800,
                                  38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000, 2000000};
constexpr double kBaudTolerance = 0.04; // 3.7 % is the worst an Arduino does (230,400 baud)
constexpr double kAheadTicks = 64; // the tile's last instruction may already have passed the end of its turn

} // namespace

void HostPort::follow(uint32_t bit_cycles) {
    if (bit_cycles == 0 || bit_cycles == followed_bit_cycles_) {
        return;
    }
    followed_bit_cycles_ = bit_cycles;
    baud_ = kTicksPerSecond / bit_cycles;
    for (const double usual : kUsualBauds) {
        if (std::abs(usual / baud_ - 1) <= kBaudTolerance) {
            baud_ = usual;
            return;
        }
    }
}

void HostPort::edge(avr::PinId, uint64_t cycle, bool level) {
    line_.push(static_cast<uint64_t>(std::ceil(clock_.to_ticks(cycle))), level);
}

void HostPort::run_until(double end) {
    send_until(end);
    receive_until(end);
}

void HostPort::send_until(double end) {
    while (!to_send_.empty() && line_free_ < end) {
        const uint16_t bits = kFormat.encode(to_send_.front());
        to_send_.pop_front();
        line_free_ = std::max(line_free_, end + kAheadTicks);
        for (unsigned i = 0; i < kFormat.sent_bits(); i++) {
            drive_(line_free_ + i * bit_ticks(), (bits >> i & 1) != 0);
        }
        line_free_ += kFormat.sent_bits() * bit_ticks();
    }
}

void HostPort::receive_until(double end) {
    while (line_.edges() != 0) {
        const avr::Line::Edge* fall = line_.falling_from(static_cast<uint64_t>(std::ceil(listening_from_)));
        if (fall == nullptr) {
            return;
        }
        const avr::Sampling sampling{static_cast<double>(fall->cycle), bit_ticks() / kSamplesPerBit,
                                     kSamplesPerBit};
        const double done = sampling.decided(kFormat.received_bits() - 1);
        if (done > end) {
            return;
        }
        const avr::ReceivedFrame frame = avr::read_frame(line_, sampling, kFormat);
        listening_from_ = frame.started ? done : sampling.decided(0);
        if (frame.started) {
            received_.push_back({done, static_cast<uint8_t>(frame.data)});
        }
        line_.forget_before(static_cast<uint64_t>(listening_from_));
    }
}

} // namespace tilenca
