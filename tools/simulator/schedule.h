// Who updates when, hears what of whom, and is there at all. Knows nothing of states: rounds come out, and
// whoever has states (cells.h, or the host's tensors) carries them out, in the order of the fields.
#pragma once

#include <stdint.h>

#include <memory>
#include <vector>

#include "links.h"
#include "random.h"
#include "setup.h"

namespace tilenca {

constexpr int kTicks = 20; // resolution of a step on clocks
constexpr int kUnitBits = 16;
constexpr int64_t kUnits = 1 << kUnitBits; // and of a tick, so that clocks drift in whole numbers

struct Event {
    int32_t cell;
    int32_t sides;
};

struct Round {
    std::vector<int32_t> gone;   // fall silent and dark
    std::vector<int32_t> born;   // are switched on again, in the seed state, and have heard nobody
    std::vector<Event> arrivals; // the cell's message of now arrives at these sides
    std::vector<Event> updates;  // the cell updates, and reads zeros for these sides
};

class Schedule {
  public:
    virtual ~Schedule() = default;

    // Plans the next round; true when it is the last one of a step.
    bool next(Round& round);

    // Cells that are never asked what they show: never there, dead or stuck.
    bool counts(int cell) const { return counts_[cell] != 0; }

    const Links& links() const { return links_; }

  protected:
    // Of the runs [first, last); `rounds` make a step; rounds count from `start`.
    Schedule(const TilencaSetup& setup, int first, int last, int rounds, int start);

    virtual void plan(Round& round) = 0;
    virtual void switch_off(int cell) = 0;
    virtual void switch_on(int cell) = 0;

    int cells() const { return static_cast<int>(on_.size()); }
    Random& random_of(int cell) { return random_[run_[cell]]; }

    int now_;                     // round
    std::vector<int32_t> starts_; // [run], and the end
    std::vector<Random> random_;  // [run]
    std::vector<uint8_t> on_;
    std::vector<uint8_t> stuck_;
    Links links_;

  private:
    void begin_step(Round& round, int64_t step);

    const TilencaSetup& setup_;
    int first_, last_, rounds_;
    std::vector<int32_t> run_; // [cell]
    std::vector<uint8_t> counts_;
};

// The schedule that the setup asks for; the setup must outlive it.
std::unique_ptr<Schedule> make_schedule(const TilencaSetup& setup, int first, int last);

} // namespace tilenca
