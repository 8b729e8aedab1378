// Finds out what is connected to a side, and whether the lines to it are whole. It owns no port.
//
// Each side sends small packets that name it. A packet that names the own side came back through a loop-back
// plug. One that names the opposite side is from the neighbour, and says whether the neighbour hears this
// tile.
#pragma once

#include <stdint.h>

#include "core/side.h"

namespace tilenca {

enum class Verdict : uint8_t {
    Waiting,    // the first window is not over
    Nothing,    // heard nothing
    Low,        // the line was never high
    LoopBack,   // heard everything that this side sent
    Neighbour,  // heard a tile that hears this one
    OneWay,     // heard a tile that does not hear this one
    Unreliable, // packets were lost
};

constexpr bool is_good(Verdict verdict) {
    return verdict == Verdict::LoopBack || verdict == Verdict::Neighbour;
}

class SideCheck {
  public:
    static constexpr uint8_t kPacketSize = 8;
    // How often to send a packet, and to call judge().
    static constexpr uint8_t kPacketMs = 10;
    static constexpr uint16_t kWindowMs = 500;

    explicit SideCheck(Side side) : side_(side) {}

    // Writes the next packet to send.
    void write_packet(uint8_t (&packet)[kPacketSize]);

    // Takes the next byte from the line.
    void receive(uint8_t byte, uint32_t now_ms);

    // Takes the line's present level; call it now and then.
    void look(bool high) { was_high_ |= high; }

    // Ends a window and judges it. True if the verdict has changed.
    bool judge();

    // Whether the neighbour's clock is known, and by how many thousandths it is slower than this tile's. A
    // neighbour sends a packet every kPacketMs of its own time; seconds of them are enough.
    bool knows_clock() const { return knows_clock_ && verdict_ == Verdict::Neighbour; }
    int16_t slower_permille() const { return slower_permille_; }
    static constexpr uint8_t kMostPermille = 16; // of two resonators that are well

    Verdict verdict() const { return verdict_; }

    // How many packets got lost in the last window.
    uint8_t lost() const { return lost_; }

  private:
    void accept(uint8_t from, uint8_t sequence, uint32_t now_ms);
    void compare_clocks();
    Verdict found() const;

    Side side_;
    Verdict verdict_ = Verdict::Waiting;
    uint8_t window_[kPacketSize] = {}; // the last bytes received
    uint8_t sequence_out_ = 0;
    uint8_t sequence_in_ = 0;
    bool in_sequence_ = false; // whether the next packet has to follow sequence_in_

    // Since the clocks are compared.
    static constexpr uint16_t kComparedPackets = 200;
    uint32_t began_ms_ = 0;
    uint32_t last_ms_ = 0;
    uint16_t packets_ = 0;
    bool comparing_ = false;
    bool knows_clock_ = false;
    int16_t slower_permille_ = 0;

    // The present window.
    Side from_ = Side::North;
    uint8_t received_ = 0;
    uint8_t missed_ = 0;
    bool heard_us_ = false;
    bool was_high_ = false;

    // The last window.
    uint8_t lost_ = 0;
    bool hears_ = false; // whether anything came
};

} // namespace tilenca
