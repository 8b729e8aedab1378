#include "board_test/side_check.h"

#include <string.h>

#include "core/crc16.h"

namespace tilenca {

namespace {

constexpr uint8_t kMark = 'T';
constexpr uint8_t kHearsFlag = 0x10; // or-ed to the side: the sender hears its neighbour
constexpr uint8_t kSideMask = 0x0F;
constexpr uint8_t kChecked = SideCheck::kPacketSize - 2;

} // namespace

void SideCheck::write_packet(uint8_t (&packet)[kPacketSize]) {
    const bool hears = received_ != 0 || hears_;
    packet[0] = kMark;
    packet[1] = static_cast<uint8_t>(index_of(side_) | (hears ? kHearsFlag : 0));
    packet[2] = sequence_out_++;
    packet[3] = 0x00; // the slowest byte, and the fastest
    packet[4] = 0x55;
    packet[5] = 0xFF;
    const uint16_t crc = crc16(packet, kChecked);
    packet[6] = static_cast<uint8_t>(crc);
    packet[7] = static_cast<uint8_t>(crc >> 8);
}

void SideCheck::receive(uint8_t byte, uint32_t now_ms) {
    memmove(window_, window_ + 1, kPacketSize - 1);
    window_[kPacketSize - 1] = byte;
    const uint16_t crc = static_cast<uint16_t>(window_[6] | static_cast<uint16_t>(window_[7]) << 8);
    const Side from = side_at(window_[1] & kSideMask);
    const bool fits = from == side_ || from == opposite(side_);
    if (window_[0] == kMark && fits && crc == crc16(window_, kChecked)) {
        accept(window_[1], window_[2], now_ms);
    }
}

void SideCheck::accept(uint8_t from, uint8_t sequence, uint32_t now_ms) {
    if (!comparing_) {
        comparing_ = true;
        began_ms_ = now_ms;
        packets_ = 0;
    } else {
        packets_ += static_cast<uint8_t>(sequence - sequence_in_);
    }
    last_ms_ = now_ms;
    if (in_sequence_) {
        missed_ = static_cast<uint8_t>(missed_ + static_cast<uint8_t>(sequence - sequence_in_ - 1));
    }
    in_sequence_ = true;
    sequence_in_ = sequence;
    from_ = side_at(from & kSideMask);
    heard_us_ = from & kHearsFlag;
    ++received_;
}

Verdict SideCheck::found() const {
    if (received_ == 0) {
        return was_high_ ? Verdict::Nothing : Verdict::Low;
    }
    if (missed_ != 0) {
        return Verdict::Unreliable;
    }
    if (from_ == side_) {
        return Verdict::LoopBack;
    }
    return heard_us_ ? Verdict::Neighbour : Verdict::OneWay;
}

// The main loop sees a packet up to a millisecond late: of two seconds, half a thousandth.
void SideCheck::compare_clocks() {
    if (received_ == 0) {
        comparing_ = knows_clock_ = false;
    } else if (packets_ >= kComparedPackets) {
        const int32_t theirs_ms = static_cast<int32_t>(packets_) * kPacketMs;
        const int32_t ours_ms = static_cast<int32_t>(last_ms_ - began_ms_);
        slower_permille_ = static_cast<int16_t>((ours_ms - theirs_ms) * 1000 / theirs_ms);
        knows_clock_ = true;
        comparing_ = false;
    }
}

bool SideCheck::judge() {
    compare_clocks();
    const Verdict before = verdict_;
    verdict_ = found();
    lost_ = missed_;
    hears_ = received_ != 0;
    in_sequence_ = hears_; // after silence any packet may come next
    received_ = missed_ = 0;
    was_high_ = false;
    return verdict_ != before;
}

} // namespace tilenca
