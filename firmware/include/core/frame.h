// Frames between tiles: docs/PROTOCOL.md section 1. Twin of host/tilenca/protocol/frames.py.
#pragma once

#include <stdint.h>

#include "core/network.h"
#include "core/side.h"

namespace tilenca {

constexpr uint8_t kProtocolVersion = 2;
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
// Owns no port: feed it from an interrupt, a test, or a simulator. One decoder per side.
class FrameDecoder {
  public:
    enum class Result : uint8_t { Pending, Ready, Corrupt };

    explicit FrameDecoder(uint8_t channels) : channels_(channels) {}

    // Takes the next byte of the line. Corrupt is said once per damaged frame, at its delimiter; the frame
    // after it is received as if nothing had been.
    Result feed(uint8_t byte);

    // Of the frame that was Ready; both valid until the next feed().
    FrameHeader header() const;
    const int8_t* messages() const { return reinterpret_cast<const int8_t*>(bytes_ + 1 + kHeaderSize); }

  private:
    Result end_of_frame() __attribute__((noinline)); // most bytes have little to do with it
    bool decode();
    bool undo_cobs();
    uint8_t whole_size() const { return 1 + kHeaderSize + channels_ + kCrcSize; } // less the delimiter

    uint8_t channels_;
    uint8_t size_ = 0; // bytes since the last delimiter; stops one beyond what fits
    uint8_t bytes_[kMaxPayload + 1] = {};
};

} // namespace tilenca
