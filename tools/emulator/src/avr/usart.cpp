#include "avr/usart.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint8_t kRxc = 0x80, kTxc = 0x40, kUdre = 0x20, kFe = 0x10, kDor = 0x08, kUpe = 0x04, kU2x = 0x02;
constexpr uint8_t kRxcie = 0x80, kTxcie = 0x40, kUdrie = 0x20, kRxen = 0x10, kTxen = 0x08, kUcsz2 = 0x04;
constexpr uint8_t kRxb8 = 0x02, kTxb8 = 0x01, kMpcm = 0x01;
constexpr unsigned kUbrrLow = 4, kUbrrHigh = 5, kUdr = 6;

struct Place {
    uint16_t base;
    uint8_t first_vector;
    PinId receive, transmit;
};

constexpr Place kPlaces[4] = {
    {0xC0, kVectorUsart0Receive, {port_index('E'), 0}, {port_index('E'), 1}},
    {0xC8, kVectorUsart1Receive, {port_index('D'), 2}, {port_index('D'), 3}},
    {0xD0, kVectorUsart2Receive, {port_index('H'), 0}, {port_index('H'), 1}},
    {0x130, kVectorUsart3Receive, {port_index('J'), 0}, {port_index('J'), 1}},
};

} // namespace

Usart::Usart(const Core& core, Gpio& gpio, unsigned number)
    : Peripheral(core), gpio_(gpio), base_(kPlaces[number].base), first_vector_(kPlaces[number].first_vector),
      receive_slot_(Slot::Receive0 + number), transmit_slot_(Slot::Transmit0 + number),
      receive_pin_(kPlaces[number].receive), transmit_pin_(kPlaces[number].transmit) {}

std::vector<uint16_t> Usart::registers() const {
    std::vector<uint16_t> all;
    for (unsigned offset : {0u, 1u, 2u, kUbrrLow, kUbrrHigh, kUdr}) {
        all.push_back(static_cast<uint16_t>(base_ + offset));
    }
    return all;
}

std::vector<uint8_t> Usart::vectors() const {
    return {first_vector_, static_cast<uint8_t>(first_vector_ + 1), static_cast<uint8_t>(first_vector_ + 2)};
}

uint32_t Usart::sample_cycles() const {
    return (byte(base_ + kUbrrLow) | (byte(base_ + kUbrrHigh) & 15u) << 8) + 1;
}

unsigned Usart::samples_per_bit() const {
    return (byte(a()) & kU2x) != 0 ? 8 : 16;
}

uint32_t Usart::bit_cycles() const {
    const bool is_on = (byte(b()) & (kRxen | kTxen)) != 0;
    return is_on ? sample_cycles() * samples_per_bit() : 0;
}

FrameFormat Usart::format() const {
    const uint8_t size = byte(c()) >> 1 & 3;
    const bool nine = (byte(b()) & kUcsz2) != 0;
    return {static_cast<uint8_t>(nine ? 9 : 5 + size), static_cast<uint8_t>(byte(c()) >> 4 & 3),
            static_cast<uint8_t>((byte(c()) & 8) != 0 ? 2 : 1)};
}

// The baud generator runs freely: things happen on its ticks.
uint64_t Usart::next_sample(uint64_t cycle) const {
    const uint64_t period = sample_cycles(), late = (cycle - baud_origin_) % period;
    return late == 0 ? cycle : cycle + period - late;
}

uint8_t Usart::status() const {
    uint8_t value = byte(a()) & (kU2x | kMpcm);
    value |= sent_flag_ ? kTxc : 0;
    value |= buffer_full_ ? 0 : kUdre;
    if (waiting_ != 0) {
        value |= kRxc;
        value |= fifo_[0].framing_error ? kFe : 0;
        value |= fifo_[0].overrun ? kDor : 0;
        value |= fifo_[0].parity_error ? kUpe : 0;
    }
    return value;
}

uint8_t Usart::read(uint16_t address, uint64_t) {
    switch (address - base_) {
    case 0:
        return status();
    case 1:
        return static_cast<uint8_t>((byte(b()) & ~kRxb8) |
                                    (waiting_ != 0 && fifo_[0].data > 0xFF ? kRxb8 : 0));
    case kUdr:
        return take_received();
    default:
        return byte(address);
    }
}

void Usart::write(uint16_t address, uint8_t value, uint64_t cycle) {
    switch (address - base_) {
    case 0:
        sent_flag_ = sent_flag_ && (value & kTxc) == 0;
        byte(address) = value & (kU2x | kMpcm);
        break;
    case 1:
        write_control(value, cycle);
        break;
    case 2:
        byte(address) = value;
        if ((value & 0xC0) != 0) {
            core_.warnings.once("USART in synchronous or SPI mode (UMSEL)");
        }
        break;
    case kUbrrLow:
        byte(address) = value;
        baud_origin_ = cycle;
        break;
    case kUdr:
        send(value, cycle);
        break;
    default:
        byte(address) = value;
    }
    update_requests();
}

void Usart::write_control(uint8_t value, uint64_t cycle) {
    const uint8_t before = byte(b());
    byte(b()) = value;
    if ((value & ~before & kTxen) != 0 && !sending_) {
        gpio_.take_over(transmit_pin_, nullptr, true, cycle);
        gpio_.announce(transmit_pin_, cycle, true);
    } else if ((before & ~value & kTxen) != 0 && !sending_) {
        gpio_.release(transmit_pin_, cycle);
    }
    if ((value & ~before & kRxen) != 0) {
        await_start(cycle);
    } else if ((before & ~value & kRxen) != 0) {
        receiver_ = Receiver::Off;
        waiting_ = 0;
        lost_ = false;
        core_.schedule.cancel(receive_slot_);
    }
}

// --- transmitter ---

void Usart::send(uint8_t data, uint64_t cycle) {
    if ((byte(b()) & kTxen) == 0 || buffer_full_) {
        return; // the chip ignores it, too
    }
    const auto word = static_cast<uint16_t>(data | (byte(b()) & kTxb8) << 8);
    if (sending_) {
        buffer_ = word;
        buffer_full_ = true;
    } else {
        start_frame(word, next_sample(cycle));
    }
}

void Usart::start_frame(uint16_t data, uint64_t cycle) {
    const FrameFormat form = format();
    const uint16_t bits = form.encode(data);
    const uint64_t bit_cycles = uint64_t{sample_cycles()} * samples_per_bit();
    bool level = true;
    for (unsigned i = 0; i < form.sent_bits(); i++) {
        if (const bool bit = (bits >> i & 1) != 0; bit != level) {
            gpio_.announce(transmit_pin_, cycle + i * bit_cycles, bit);
            level = bit;
        }
    }
    sending_ = true;
    core_.schedule.set(transmit_slot_, cycle + form.sent_bits() * bit_cycles);
}

void Usart::frame_sent(uint64_t cycle) {
    sending_ = false;
    core_.schedule.cancel(transmit_slot_);
    if (buffer_full_) {
        buffer_full_ = false;
        start_frame(buffer_, cycle);
    } else {
        sent_flag_ = true;
        if ((byte(b()) & kTxen) == 0) {
            gpio_.release(transmit_pin_, cycle);
        }
    }
}

void Usart::on_event(Slot slot, uint64_t cycle) {
    if (slot == transmit_slot_) {
        frame_sent(cycle);
        update_requests();
    } else if (receiver_ == Receiver::Starting) {
        start_bit_seen();
    } else {
        frame_received(cycle);
    }
}

void Usart::update_requests() {
    const uint8_t enabled = byte(b());
    core_.cpu.request(first_vector_, waiting_ != 0 && (enabled & kRxcie) != 0);
    core_.cpu.request(first_vector_ + 1, !buffer_full_ && (enabled & kUdrie) != 0);
    core_.cpu.request(first_vector_ + 2, sent_flag_ && (enabled & kTxcie) != 0);
}

void Usart::interrupt_taken(uint8_t vector) {
    if (vector == first_vector_ + 2) {
        sent_flag_ = false;
        update_requests();
    }
}

void Usart::reset(uint64_t cycle) {
    core_.schedule.cancel(receive_slot_);
    core_.schedule.cancel(transmit_slot_);
    gpio_.announce_port(transmit_pin_, cycle); // the rest of a frame under way is never sent
    sending_ = sent_flag_ = buffer_full_ = lost_ = start_is_noise_ = false;
    waiting_ = 0;
    receiver_ = Receiver::Off;
    baud_origin_ = cycle;
}

void Usart::clock_stops(uint64_t) {
    core_.schedule.stop(receive_slot_);
    core_.schedule.stop(transmit_slot_);
}

// What was being received is garbled; the receiver listens for the next start bit.
void Usart::clock_starts(uint64_t cycle, uint64_t stood) {
    baud_origin_ += stood;
    core_.schedule.go_on(receive_slot_, stood);
    core_.schedule.go_on(transmit_slot_, stood);
    if (receiver_ != Receiver::Off) {
        await_start(cycle);
    }
}

void Usart::state(Archive& archive) {
    archive(baud_origin_, sending_, sent_flag_, buffer_full_, buffer_, receiver_, sampling_, receive_format_,
            fifo_, waiting_, lost_, last_data_, start_is_noise_);
    archive.require(waiting_ <= fifo_.size(), "a receiver holds more than it can");
    const bool is_busy = receiver_ == Receiver::Starting || receiver_ == Receiver::Receiving;
    archive.require(is_busy ? gpio_.line(receive_pin_) != nullptr
                            : core_.schedule.due(receive_slot_) == kNever,
                    "a receiver awaits what cannot come");
}

} // namespace tilenca::avr
