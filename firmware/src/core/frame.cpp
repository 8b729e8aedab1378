#include "core/frame.h"

#include "core/crc16.h"

namespace tilenca {

namespace {

constexpr uint8_t kVersionAndKind = kProtocolVersion << 4 | kKindState << 2;
constexpr uint8_t kSideBits = 3;

// Replaces every zero of bytes[1..size] by the distance to the next one; bytes[0] starts the chain. The
// payload is shorter than COBS's longest block, so no block has to be split.
void do_cobs(uint8_t* bytes, uint8_t size) {
    uint8_t code_at = 0;
    for (uint8_t i = 1; i <= size; ++i) {
        if (bytes[i] == 0) {
            bytes[code_at] = i - code_at;
            code_at = i;
        }
    }
    bytes[code_at] = size + 1 - code_at;
}

} // namespace

uint8_t encode_frame(FrameHeader header, const int8_t* messages, uint8_t channels, uint8_t* wire) {
    uint8_t* payload = wire + 1;
    uint8_t size = 0;
    payload[size++] = kVersionAndKind | index_of(header.side);
    payload[size++] = header.tile;
    payload[size++] = header.sequence;
    payload[size++] = static_cast<uint8_t>(header.model_id);
    payload[size++] = static_cast<uint8_t>(header.model_id >> 8);
    for (uint8_t c = 0; c < channels; ++c) {
        payload[size++] = static_cast<uint8_t>(messages[c]) + kMessageOffset;
    }
    const uint16_t crc = crc16(payload, size);
    payload[size++] = static_cast<uint8_t>(crc);
    payload[size++] = static_cast<uint8_t>(crc >> 8);
    do_cobs(wire, size);
    wire[size + 1] = 0;
    return size + 2;
}

FrameDecoder::Result FrameDecoder::feed(uint8_t byte) {
    const uint8_t whole = whole_size();
    if (byte != 0) {
        if (size_ < whole) {
            bytes_[size_] = byte;
        }
        if (size_ <= whole) {
            ++size_;
        }
        return Result::Pending;
    }
    return end_of_frame();
}

FrameDecoder::Result FrameDecoder::end_of_frame() {
    if (size_ == 0) {
        return Result::Pending;
    }
    const bool good = size_ == whole_size() && decode();
    size_ = 0;
    return good ? Result::Ready : Result::Corrupt;
}

FrameHeader FrameDecoder::header() const {
    const uint8_t* payload = bytes_ + 1;
    return {side_at(payload[0] & kSideBits), payload[1], payload[2],
            static_cast<uint16_t>(payload[3] | static_cast<uint16_t>(payload[4]) << 8)};
}

bool FrameDecoder::decode() {
    if (!undo_cobs()) {
        return false;
    }
    uint8_t* payload = bytes_ + 1;
    const uint8_t checked = kHeaderSize + channels_;
    const uint16_t crc = payload[checked] | static_cast<uint16_t>(payload[checked + 1]) << 8;
    if ((payload[0] & ~kSideBits) != kVersionAndKind || crc != crc16(payload, checked)) {
        return false;
    }
    for (uint8_t i = kHeaderSize; i < checked; ++i) {
        if (payload[i] == 0) {
            return false; // message -128 does not exist
        }
        payload[i] -= kMessageOffset;
    }
    return true;
}

// Puts the zeros back in place; false if the chain of codes does not end at the end.
bool FrameDecoder::undo_cobs() {
    uint16_t at = bytes_[0]; // 16 bits: a damaged code may point far beyond the end, and must not wrap
    while (at < size_) {
        const uint8_t distance = bytes_[at];
        bytes_[at] = 0;
        at += distance;
    }
    return at == size_;
}

} // namespace tilenca
