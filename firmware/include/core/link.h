// The neighbour on one side: its last message, whether it is still there, and the counters of the line.
#pragma once

#include <stdint.h>

#include "core/frame.h"

namespace tilenca {

constexpr uint8_t kSilentPeriods = 6;
constexpr uint16_t kMaxPeriodMs = 10000; // of any tile

constexpr uint32_t silence_ms(uint16_t period_ms) {
    return static_cast<uint32_t>(period_ms) * kSilentPeriods;
}

// docs/PROTOCOL.md section 1 defines them.
struct LinkCounters {
    uint32_t sent = 0;
    uint32_t received = 0;
    uint32_t corrupt = 0;
    uint32_t lost = 0;
    uint32_t foreign = 0;
};

class Link {
  public:
    // `period_ms` is the tile's own. A neighbour is silent when its last good frame is older than
    // silence_ms() of the longer one of both periods. The neighbour's is learnt from its frames.
    Link(uint16_t model_id, uint8_t channels, uint16_t period_ms);

    void set_period(uint16_t period_ms) { period_ms_ = period_ms; }

    // Takes the next byte from the line.
    void receive(uint8_t byte, uint32_t now_ms);

    // Notices silence. Call it at least once per silence_ms().
    void tick(uint32_t now_ms);

    // Whether the neighbour has been heard lately and runs the same model.
    bool alive() const { return who_ == Who::Neighbour; }

    // Its last message, `channels` values, or nullptr while not alive. Valid until the next receive() or
    // tick().
    const int8_t* message() const { return alive() ? message_ : nullptr; }

    // Whether the neighbour has been heard lately and runs another model.
    bool foreign() const { return who_ == Who::Stranger; }

    // Writes the next frame to the neighbour, at most kMaxFrame bytes, and counts it as sent. `side` and
    // `tile` are the sender's.
    uint8_t send(Side side, uint8_t tile, const int8_t* message, uint8_t* wire) __attribute__((noinline));

    // Whether a good frame ever came. If so, the age of the last one, and the id and side of its sender.
    bool ever_received() const { return counters_.received != 0; }
    uint32_t age_ms(uint32_t now_ms) const { return now_ms - last_ms_; }
    uint8_t neighbour() const { return neighbour_; }
    Side neighbour_side() const { return neighbour_side_; }

    const LinkCounters& counters() const { return counters_; }

  private:
    enum class Who : uint8_t { NobodyYet, Silence, Neighbour, Stranger };

    // Not inlined, like send(), so that the loop over single bytes keeps its variables in registers.
    void frame_ended(bool good, uint32_t now_ms) __attribute__((noinline));
    void accept(uint32_t now_ms);
    void learn_pace(uint32_t now_ms);

    uint16_t model_id_;
    uint8_t channels_;
    uint16_t period_ms_;
    uint16_t pace_ms_ = 0; // the longest recent time from one frame to the next
    FrameDecoder decoder_;
    LinkCounters counters_;
    Who who_ = Who::NobodyYet;
    uint8_t neighbour_ = 0;
    Side neighbour_side_ = Side::North;
    uint8_t sequence_in_ = 0;  // of the last frame, a stranger's included
    uint8_t sequence_out_ = 0; // of the next frame to send
    uint32_t heard_ms_ = 0;    // when that frame came
    uint32_t last_ms_ = 0;     // when the last good one came
    int8_t message_[kMaxChannels] = {};
};

} // namespace tilenca
