// What is known of the neighbour on one side: its last message, whether it still speaks, and how well the
// line does.
#pragma once

#include <stdint.h>

#include "core/frame.h"

namespace tilenca {

constexpr uint8_t kSilentPeriods = 6;
constexpr uint8_t kSilentExtraMs = 20;

constexpr uint32_t silence_ms(uint16_t period_ms) {
    return static_cast<uint32_t>(period_ms) * kSilentPeriods + kSilentExtraMs;
}

// docs/PROTOCOL.md section 1 says what each counts.
struct LinkCounters {
    uint32_t sent = 0;
    uint32_t received = 0;
    uint32_t corrupt = 0;
    uint32_t lost = 0;
    uint32_t foreign = 0;
};

class Link {
  public:
    // `timeout_ms`: a neighbour whose last good frame is older is silent.
    Link(uint16_t model_id, uint8_t channels, uint32_t timeout_ms);

    void set_timeout(uint32_t timeout_ms) { timeout_ms_ = timeout_ms; }

    // Takes the next byte from the line.
    void receive(uint8_t byte, uint32_t now_ms);

    // Lets silence pass; call it at least once per time-out.
    void tick(uint32_t now_ms);

    // Whether the neighbour spoke lately and runs the same model.
    bool alive() const { return alive_; }

    // Its last message, `channels` values, or nullptr while not alive. Valid until the next receive() or
    // tick().
    const int8_t* message() const { return alive_ ? message_ : nullptr; }

    // Whether somebody speaks who runs another model.
    bool foreign() const { return foreign_; }

    // Writes the next frame to the neighbour (at most kMaxFrame bytes), from this side of the tile with this
    // id, and counts it as sent.
    uint8_t send(Side side, uint8_t tile, const int8_t* message, uint8_t* wire);

    // Whether a good frame ever came, when the last one did, and whence: the neighbour's id and its side.
    bool ever_received() const { return counters_.received != 0; }
    uint32_t age_ms(uint32_t now_ms) const { return now_ms - last_ms_; }
    uint8_t neighbour() const { return neighbour_; }
    Side neighbour_side() const { return neighbour_side_; }

    const LinkCounters& counters() const { return counters_; }

  private:
    void accept(uint32_t now_ms);

    uint16_t model_id_;
    uint8_t channels_;
    uint32_t timeout_ms_;
    FrameDecoder decoder_;
    LinkCounters counters_;
    bool alive_ = false;
    bool foreign_ = false;
    uint8_t neighbour_ = 0;
    Side neighbour_side_ = Side::North;
    uint8_t sequence_in_ = 0;  // of the last good frame
    uint8_t sequence_out_ = 0; // of the next frame to send
    uint32_t last_ms_ = 0;
    uint32_t last_foreign_ms_ = 0;
    int8_t message_[kMaxChannels] = {};
};

} // namespace tilenca
