// Many tiles, wired, in step: each runs a quantum of time, then the next; what one sends reaches another only
// after a latency longer than the quantum. So nobody can receive what has not been sent yet, and the outcome
// does not depend on the order in which the tiles run.
#pragma once

#include "image/image.h"
#include "tile/tile.h"

#include <memory>
#include <string>
#include <vector>

namespace tilenca {

constexpr double kQuantumTicks = 256;
constexpr double kLinkLatencyTicks = 320; // 20 us; the margin covers the last instruction of a quantum

class Array {
  public:
    struct Wiring {
        unsigned tile, side, other_tile, other_side;
    };

    Array(const Image& image, const avr::Fuses& fuses, const std::vector<Clock>& clocks);

    // Joins two sides, both directions.
    void link(const Wiring& wiring);
    // Runs on, in whole quanta on a fixed grid: how a caller cuts time into calls changes nothing.
    void run_for(double ticks);
    // A whole number of quanta: less than one beyond all that was asked for.
    double now() const { return now_; }
    Tile& tile(unsigned index) { return *tiles_[index]; }
    unsigned size() const { return static_cast<unsigned>(tiles_.size()); }
    // What stopped a tile: the program counter, the function, the fact; empty: it runs.
    std::string fault(unsigned index);

  private:
    // One direction of a cable: what leaves one tile's pin arrives at another's.
    class Wire : public avr::EdgeListener {
      public:
        Wire(const Clock& from, Tile& to, avr::PinId to_pin) : from_(from), to_(to), to_pin_(to_pin) {}
        void edge(avr::PinId pin, uint64_t cycle, bool level) override;

      private:
        const Clock& from_;
        Tile& to_;
        avr::PinId to_pin_;
    };

    void connect(Tile& from, unsigned from_side, Tile& to, unsigned to_side);
    double idle_until();

    Image image_; // for its symbols
    std::vector<std::unique_ptr<Tile>> tiles_;
    std::vector<std::unique_ptr<Wire>> wires_;
    double now_ = 0;
    double asked_for_ = 0;
};

} // namespace tilenca
