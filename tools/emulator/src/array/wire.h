// One direction of a cable: what leaves one tile's pin arrives at another's, late, and not always whole.
//
// The sending tile writes, the receiving tile reads what was written in the last turn: so the two may run at
// the same time on two processors.
#pragma once

#include "avr/random.h"
#include "tile/tile.h"

#include <deque>

namespace tilenca {

// What goes wrong on a wire. Bytes are found by their start bits, as 8N1.
struct WireFault {
    double loss = 0;  // share of bytes that never arrive (0..1)
    double flip = 0;  // share of data bits that arrive inverted (0..1)
    double delay = 0; // ticks more than usual
    double baud = 0;  // 0: that of the USART at either end

    bool harms() const { return loss > 0 || flip > 0; }
};

class Wire : public avr::EdgeListener {
  public:
    // Ends of a cable by tile and side.
    struct End {
        unsigned tile, side;
    };
    struct Counts {
        uint64_t bytes = 0, lost = 0, flipped = 0; // bytes seen and lost, bits flipped; only on a faulty wire
    };

    // What the wires of an array have in common.
    struct Common {
        double delay = 0;                        // ticks that everything takes
        avr::Drive unpowered = avr::Drive::High; // what a tile without power does to its neighbours
    };

    Wire(Tile& from, Tile& to, End from_end, End to_end, const Common& common, double now);
    ~Wire() override;
    Wire(const Wire&) = delete;
    Wire& operator=(const Wire&) = delete;

    End from() const { return from_end_; }
    End to() const { return to_end_; }
    bool is_connected() const { return connected_; }
    void set_connected(bool connected, double now);
    void set_fault(const WireFault& fault, uint64_t seed);
    const Counts& counts() const { return counts_; }

    void edge(avr::PinId pin, uint64_t cycle, bool level, bool open) override;
    // The sender was switched on or off.
    void power_changed(double now) { drive_anew(now); }
    // Of the sender's turn: all before `end` is certain.
    void settle(double end);
    // Of the receiver's turn: hands over what was sent before this turn; false: nothing was.
    bool deliver() { return !sent_[1 - to_.list()].edges.empty() && hand_over(); }
    // The end of the receiver's turn, or of a piece of it.
    void note_receiver(bool turn_ends) {
        others_bit_[to_.list()] = turn_ends ? to_.bit_ticks(to_pin_) : others_bit_[1 - to_.list()];
    }
    // When it next has to be looked at, in ticks: at once, if something waits to be delivered.
    double pending() const;
    bool has_fault() const { return fault_.harms(); }
    void state(avr::Archive& archive);

  private:
    struct Edge {
        double ticks;
        avr::Drive drive;
        void state(avr::Archive& archive) { archive(ticks, drive); }
    };

    // Two threads use them at the same time, so each has a cache line of its own.
    struct alignas(64) List {
        std::vector<Edge> edges;
    };

    bool hand_over();
    void start_byte(double ticks);
    void pass_borders(double until);
    void send(double ticks);
    void put(double ticks, avr::Drive drive) { sent_[from_.list()].edges.push_back({ticks, drive}); }
    void drive_anew(double now);
    double bit_ticks();

    Tile &from_, &to_;
    End from_end_, to_end_;
    avr::PinId from_pin_, to_pin_;
    const Common& common_;
    List sent_[2]; // which one a tile writes, and which it reads, changes every turn
    bool connected_ = true;

    WireFault fault_;
    avr::Random random_;
    Counts counts_;
    std::deque<Edge> raw_; // announced, and not certain yet
    avr::Drive raw_drive_ = avr::Drive::Open, out_drive_ = avr::Drive::Open;
    bool muted_ = false, flipping_ = false;
    uint8_t flips_ = 0;
    double start_ = 0, bit_ = 0;
    // A bit of the receiving USART, by the receiver's list: the sender reads what it was a turn ago.
    double others_bit_[2] = {0, 0};
    unsigned border_ = kNoByte; // the next bit border of the byte under way
    static constexpr unsigned kNoByte = 0, kLastBorder = 10;
};

} // namespace tilenca
