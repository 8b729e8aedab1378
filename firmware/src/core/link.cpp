#include "core/link.h"

#include <string.h>

namespace tilenca {

namespace {

uint16_t longer(uint16_t a, uint16_t b) {
    return a > b ? a : b;
}

} // namespace

Link::Link(uint16_t model_id, uint8_t channels, uint16_t period_ms)
    : model_id_(model_id), channels_(channels), period_ms_(period_ms), decoder_(channels) {}

void Link::receive(uint8_t byte, uint32_t now_ms) {
    const FrameDecoder::Result result = decoder_.feed(byte);
    if (result != FrameDecoder::Result::Pending) {
        frame_ended(result == FrameDecoder::Result::Ready, now_ms);
    }
}

void Link::frame_ended(bool good, uint32_t now_ms) {
    if (good) {
        tick(now_ms); // after a silence, the frames that were missed during it do not count as lost
        accept(now_ms);
    } else {
        ++counters_.corrupt;
    }
}

void Link::accept(uint32_t now_ms) {
    const FrameHeader header = decoder_.header();
    const uint8_t missed = static_cast<uint8_t>(header.sequence - sequence_in_ - 1);
    if (missed == 0) {
        learn_pace(now_ms);
    }
    sequence_in_ = header.sequence;
    heard_ms_ = now_ms;
    if (header.model_id != model_id_) {
        ++counters_.foreign;
        who_ = Who::Stranger;
        return;
    }
    if (alive()) {
        counters_.lost += missed;
    }
    ++counters_.received;
    who_ = Who::Neighbour;
    neighbour_ = header.tile;
    neighbour_side_ = header.side;
    last_ms_ = now_ms;
    memcpy(message_, decoder_.messages(), channels_);
}

// Two frames with consecutive sequence numbers are one period of their sender apart. The longest such time
// counts, so that a slow tile does not seem to come and go; faster frames let it decay.
void Link::learn_pace(uint32_t now_ms) {
    if (who_ == Who::NobodyYet) {
        return;
    }
    const uint32_t passed_ms = now_ms - heard_ms_;
    const uint16_t pace_ms = passed_ms < kMaxPeriodMs ? static_cast<uint16_t>(passed_ms) : kMaxPeriodMs;
    pace_ms_ -= pace_ms_ / 4;
    pace_ms_ = longer(pace_ms_, pace_ms);
}

void Link::tick(uint32_t now_ms) {
    // A latch: the age itself starts again from zero after 49 days.
    if ((alive() || foreign()) && now_ms - heard_ms_ > silence_ms(longer(period_ms_, pace_ms_))) {
        who_ = Who::Silence;
    }
}

uint8_t Link::send(Side side, uint8_t tile, const int8_t* message, uint8_t* wire) {
    ++counters_.sent;
    return encode_frame({side, tile, sequence_out_++, model_id_}, message, channels_, wire);
}

} // namespace tilenca
