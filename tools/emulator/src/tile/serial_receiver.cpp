#include "tile/serial_receiver.h"

namespace tilenca {

namespace {

constexpr avr::FrameFormat kFormat{8, 0, 1};
constexpr unsigned kSamplesPerBit = 16;
// What terminal programs offer; a tile's divisor comes close to one of these, seldom to the point.
constexpr double kUsualBauds[] = {300,   600,   1200,  2400,   4800,   9600,   14400,  19200,   28800,
                                  38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000, 2000000};
constexpr double kLeastBaud = 0.9;      // at the greatest divisors of a USART and of its clock
constexpr double kBaudTolerance = 0.04; // 3.7 % is the worst an Arduino does (230,400 baud)

} // namespace

void SerialReceiver::follow(double bit_ticks) {
    if (bit_ticks <= 0 || bit_ticks == followed_bit_ticks_) {
        return;
    }
    followed_bit_ticks_ = bit_ticks;
    baud_ = kTicksPerSecond / bit_ticks;
    for (const double usual : kUsualBauds) {
        if (std::abs(usual / baud_ - 1) <= kBaudTolerance) {
            baud_ = usual;
            return;
        }
    }
}

void SerialReceiver::receive_until(double end) {
    while (line_.edges() != 0) {
        const auto fall = line_.falling_from(static_cast<uint64_t>(std::ceil(listening_from_)));
        if (!fall) {
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
            received_.push_back({done, static_cast<uint8_t>(frame.data), frame.framing_error});
        }
        line_.forget_before(static_cast<uint64_t>(listening_from_));
    }
}

void SerialReceiver::state(avr::Archive& archive) {
    std::vector<Byte> bytes(received_.begin(), received_.end());
    archive(baud_, followed_bit_ticks_, line_, listening_from_, bytes);
    archive.require(baud_ >= kLeastBaud && baud_ <= kTicksPerSecond && followed_bit_ticks_ >= 0 &&
                        listening_from_ >= 0,
                    "it listens as no receiver does");
    received_.assign(bytes.begin(), bytes.end());
}

} // namespace tilenca
