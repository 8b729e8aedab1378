// Finds out what is at the other end of a side, and whether the lines to it are whole. Owns no port.
//
// Each side sends small packets that name it. What comes back with the own side's name went through a
// loop-back plug; with the opposite side's, it is from the tile there, which also says whether it hears us.
#pragma once

#include <stdint.h>

#include "core/side.h"

namespace tilenca {

enum class Verdict : uint8_t {
    Waiting,    // the first window is not over
    Nothing,    // heard nothing
    Low,        // the line was never high
    LoopBack,   // heard all that was sent here
    Neighbour,  // heard a tile that hears us
    Unheard,    // heard a tile that does not
    Unreliable, // heard, but not everything
};

constexpr bool is_good(Verdict verdict) {
    return verdict == Verdict::LoopBack || verdict == Verdict::Neighbour;
}

class SideCheck {
  public:
    static constexpr uint8_t kPacketSize = 8;
    // Send one so often, and judge() so often.
    static constexpr uint8_t kPacketMs = 10;
    static constexpr uint16_t kWindowMs = 500;

    explicit SideCheck(Side side) : side_(side) {}

    // Writes the next packet to send.
    void write_packet(uint8_t (&packet)[kPacketSize]);

    // Takes the next byte from the line.
    void receive(uint8_t byte);

    // Takes the line's level now and then.
    void look(bool high) { was_high_ |= high; }

    // Ends a window, and judges it. True if the verdict is another one than before.
    bool judge();

    Verdict verdict() const { return verdict_; }

    // How many packets got lost in the last window.
    uint8_t lost() const { return lost_; }

  private:
    void accept(uint8_t from, uint8_t sequence);
    Verdict found() const;

    Side side_;
    Verdict verdict_ = Verdict::Waiting;
    uint8_t window_[kPacketSize] = {}; // the last bytes received
    uint8_t sequence_out_ = 0;
    uint8_t sequence_in_ = 0;
    bool in_sequence_ = false; // whether sequence_in_ says what has to come next

    // Of the window under way.
    Side from_ = Side::North;
    uint8_t received_ = 0;
    uint8_t missed_ = 0;
    bool heard_us_ = false;
    bool was_high_ = false;

    // Of the last one.
    uint8_t lost_ = 0;
    bool hears_ = false; // whether anything came in it
};

} // namespace tilenca
