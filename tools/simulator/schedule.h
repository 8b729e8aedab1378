// Which cells update in each tick, which messages arrive, and which cells are there at all.
//
// A schedule knows nothing of states. Their owner (cells.h, or tensors on the host) applies each tick in the
// order of its fields.
#pragma once

#include <stdint.h>

#include <memory>
#include <vector>

#include "links.h"
#include "random.h"
#include "tilenca/simulator.h"

namespace tilenca {

constexpr int kTicks = TILENCA_TICKS; // of a step on clocks
constexpr int kUnitBits = 16;
constexpr int64_t kUnits = 1 << kUnitBits; // of a tick
static_assert(kUnits == TILENCA_UNITS_PER_TICK, "the header gives the number");

using Event = tilenca_event;

struct Tick {
    std::vector<int32_t> switched_off; // fall silent and dark
    std::vector<int32_t> switched_on;  // begin in the seed state, and have no messages yet
    std::vector<Event> deliveries;     // the cell's message of now arrives at these sides
    std::vector<Event> updates;        // the cell updates, and reads zeros for these sides
    std::vector<int32_t> put_down;     // count from now on
    std::vector<int32_t> taken_away;   // count no more
};

class Schedule {
  public:
    virtual ~Schedule() = default;

    // Plans the next tick; true when it is the last one of a step.
    bool next(Tick& tick);

    // False for cells whose display does not count now: not there, dead or stuck.
    bool counts(int cell) const { return counts_[cell] != 0; }

    const Links& links() const { return links_; }

  protected:
    // Of the runs [first, last); `ticks` make a step; ticks count from `start`. A side is silent when nothing
    // came for `silent_after`, in the unit of the times that the derived class gives to `links_`.
    Schedule(const tilenca_setup& setup, int first, int last, int ticks, int start, int silent_after);

    virtual void plan(Tick& tick) = 0;
    virtual void switch_off(int cell) = 0;
    virtual void switch_on(int cell) = 0;

    int cells() const { return static_cast<int>(on_.size()); }
    Random& random_of(int cell) { return random_[run_[cell]]; }
    int ticks() const { return ticks_; }

    int now_;                     // tick
    std::vector<int32_t> starts_; // [run], and the end
    std::vector<Random> random_;  // [run]
    std::vector<uint8_t> on_;
    std::vector<uint8_t> stuck_;
    Links links_;

  private:
    void begin_fault(Tick& tick, int64_t step);
    void change(Tick& tick, int64_t step);
    void power(int cell, bool on, Tick& tick);

    const tilenca_setup& setup_;
    int first_, last_, ticks_;
    std::vector<int32_t> run_; // [cell]
    std::vector<uint8_t> counts_;
    std::vector<tilenca_change> changes_; // of these runs, by their cells within them
    size_t next_change_ = 0;
};

// The schedule that the setup asks for; the setup must outlive it.
std::unique_ptr<Schedule> make_schedule(const tilenca_setup& setup, int first, int last);

} // namespace tilenca
