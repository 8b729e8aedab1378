// The receiving half of a USART.
#include "avr/usart.h"

namespace tilenca::avr {

namespace {

constexpr uint8_t kMpcm = 0x01; // in UCSRnA
constexpr unsigned kFifo = 2;

} // namespace

void Usart::await_start(uint64_t from) {
    const Line* line = gpio_.line(receive_pin_);
    const std::optional<Line::Edge> edge = line == nullptr ? std::nullopt : line->falling_from(from);
    receiver_ = Receiver::Idle;
    core_.schedule.cancel(receive_slot_);
    if (!edge) {
        return;
    }
    start_is_noise_ = edge->is_noise;
    sampling_ = {static_cast<double>(next_sample(edge->cycle)), static_cast<double>(sample_cycles()),
                 samples_per_bit()};
    receive_format_ = format();
    // Only a byte that waits for room needs to know when the next one starts.
    receiver_ = waiting_ > kFifo ? Receiver::Starting : Receiver::Receiving;
    const unsigned bit = waiting_ > kFifo ? 0 : receive_format_.received_bits() - 1;
    core_.schedule.set(receive_slot_, static_cast<uint64_t>(sampling_.decided(bit)));
}

void Usart::line_changed() {
    const uint64_t now = core_.cpu.cycle;
    const bool expects_noise = start_is_noise_ && sampling_.start > static_cast<double>(now);
    if (receiver_ == Receiver::Idle || (receiver_ != Receiver::Off && expects_noise)) {
        await_start(now);
    }
}

uint64_t Usart::needs_line_from(uint64_t now) const {
    const bool busy = receiver_ == Receiver::Starting || receiver_ == Receiver::Receiving;
    return busy && sampling_.start < static_cast<double>(now) ? static_cast<uint64_t>(sampling_.start) : now;
}

// A new frame has begun: the byte that still waits in the shift register is gone.
void Usart::start_bit_seen() {
    const Line& line = *gpio_.line(receive_pin_);
    if (waiting_ > kFifo && read_frame(line, sampling_, receive_format_).started) {
        waiting_ = kFifo;
        lost_ = true;
    }
    receiver_ = Receiver::Receiving;
    const unsigned last = receive_format_.received_bits() - 1;
    core_.schedule.set(receive_slot_, static_cast<uint64_t>(sampling_.decided(last)));
}

void Usart::frame_received(uint64_t cycle) {
    const ReceivedFrame frame = read_frame(*gpio_.line(receive_pin_), sampling_, receive_format_);
    if (!frame.started) {
        await_start(static_cast<uint64_t>(sampling_.decided(0)));
        return;
    }
    // In multi-processor mode only addresses count: frames whose ninth bit, or else stop bit, is one.
    const bool is_address = receive_format_.data_bits == 9 ? frame.data > 0xFF : !frame.framing_error;
    if ((byte(a()) & kMpcm) != 0 && !is_address) {
        await_start(cycle - sample_cycles());
        return;
    }
    // A byte still in the shift register was dealt with when this frame's start bit was seen.
    fifo_[waiting_++] = {frame.data, frame.framing_error, frame.parity_error, lost_};
    lost_ = false;
    // The last of the three samples of a stop bit may belong to the next start bit already.
    await_start(cycle - sample_cycles());
    update_requests();
}

uint8_t Usart::take_received() {
    if (waiting_ != 0) {
        last_data_ = static_cast<uint8_t>(fifo_[0].data);
        fifo_[0] = fifo_[1];
        fifo_[1] = fifo_[2];
        waiting_--;
        update_requests();
    }
    return last_data_;
}

} // namespace tilenca::avr
