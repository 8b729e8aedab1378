#include "core/link.h"

#include <string.h>

namespace tilenca {

Link::Link(uint16_t model_id, uint8_t channels, uint32_t timeout_ms)
    : model_id_(model_id), channels_(channels), timeout_ms_(timeout_ms), decoder_(channels) {}

void Link::receive(uint8_t byte, uint32_t now_ms) {
    switch (decoder_.feed(byte)) {
    case FrameDecoder::Result::Pending:
        break;
    case FrameDecoder::Result::Corrupt:
        ++counters_.corrupt;
        break;
    case FrameDecoder::Result::Ready:
        tick(now_ms); // a frame that ends a silence must not count what was missed during it
        accept(now_ms);
        break;
    }
}

void Link::accept(uint32_t now_ms) {
    const FrameHeader header = decoder_.header();
    if (header.model_id != model_id_) {
        ++counters_.foreign;
        alive_ = false;
        foreign_ = true;
        last_foreign_ms_ = now_ms;
        return;
    }
    if (alive_) {
        counters_.lost += static_cast<uint8_t>(header.sequence - sequence_in_ - 1);
    }
    ++counters_.received;
    alive_ = true;
    foreign_ = false;
    neighbour_ = header.tile;
    neighbour_side_ = header.side;
    sequence_in_ = header.sequence;
    last_ms_ = now_ms;
    memcpy(message_, decoder_.messages(), channels_);
}

void Link::tick(uint32_t now_ms) {
    // Latches: the ages themselves start again from zero after 49 days.
    if (alive_ && age_ms(now_ms) > timeout_ms_) {
        alive_ = false;
    }
    if (foreign_ && now_ms - last_foreign_ms_ > timeout_ms_) {
        foreign_ = false;
    }
}

uint8_t Link::send(Side side, uint8_t tile, const int8_t* message, uint8_t* wire) {
    ++counters_.sent;
    return encode_frame({side, tile, sequence_out_++, model_id_}, message, channels_, wire);
}

} // namespace tilenca
