// Frames between tiles: docs/PROTOCOL.md section 1. Twin of host/tilenca/protocol/frames.py.
#pragma once

#include <stdint.h>

#include "core/network.h"
#include "core/side.h"

namespace tilenca {

constexpr uint8_t kProtocolVersion = 3;
constexpr uint8_t kKindState = 0;
constexpr uint8_t kHeaderSize = 5;
constexpr uint8_t kCrcSize = 2;
constexpr uint8_t kMessageOffset = 128;
constexpr uint8_t kMaxPayload = kHeaderSize + kMaxChannels + kCrcSize;
// COBS adds one byte to so short a payload, and the delimiter closes it.
constexpr uint8_t kMaxFrame = kMaxPayload + 2;

struct FrameHeader {
    Side side;    // of the sender, where the frame leaves
    uint8_t tile; // the sender's id, 0: not set
    uint8_t sequence;
    uint16_t model_id;
};

// Writes the frame of `channels` messages as it goes on the wire, delimiter included; returns its size, at
// most kMaxFrame.
uint8_t encode_frame(FrameHeader header, const int8_t* messages, uint8_t channels, uint8_t* wire);

// Receives one byte at a time and says when a whole, checked frame has arrived.
//
// It owns no port: an interrupt, a test or a simulator feeds it. Each side has its own.
class FrameDecoder {
  public:
    enum class Result : uint8_t { Pending, Ready, Corrupt };

    explicit FrameDecoder(uint8_t channels) : channels_(channels) {}

    // Takes the next byte of the line. A damaged frame gives Corrupt once, at its delimiter, and does not
    // affect the next frame.
    Result feed(uint8_t byte);

    // The frame that was Ready, valid until the next feed().
    FrameHeader header() const;
    const int8_t* messages() const { return reinterpret_cast<const int8_t*>(bytes_ + 1 + kHeaderSize); }

  private:
    Result end_of_frame() __attribute__((noinline)); // so that feed() is short for most bytes
    bool decode();
    bool undo_cobs();
    uint8_t whole_size() const { return 1 + kHeaderSize + channels_ + kCrcSize; } // without the delimiter

    uint8_t channels_;
    uint8_t size_ = 0; // bytes since the last delimiter, at most one more than a frame has
    uint8_t bytes_[kMaxPayload + 1] = {};
};

} // namespace tilenca
