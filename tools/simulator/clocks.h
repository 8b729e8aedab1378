// The schedule of real tiles: each has its phase, period and latencies, and starts when it is switched on.
//
// It sends its seed state at once, and updates one period after that (docs/PROTOCOL.md section 1).
#pragma once

#include "schedule.h"

namespace tilenca {

class Clocks : public Schedule {
  public:
    Clocks(const tilenca_setup& setup, int first, int last);

  private:
    void plan(Tick& tick) override;
    void switch_off(int cell) override;
    void switch_on(int cell) override;

    void boot(int cell, int64_t at);
    void update(int cell, Tick& tick);

    void send(int cell, Tick& tick);
    int64_t arrival(int cell, int side) const;
    bool deaf(int cell, int side) const;
    void await_arrival(int cell);

    enum class Next : uint8_t { Boot, Arrival, Update };

    const int64_t* period_;
    const int64_t* latency_;      // [cell][side]
    const int64_t* seed_latency_; // [cell][side], of what a tile sends when it is switched on
    int64_t line_[kSides] = {};
    std::vector<int64_t> on_since_;    // [cell], in units
    std::vector<int32_t> due_;         // [cell], the tick of its next event
    std::vector<Next> next_;           // [cell], what that event is
    std::vector<int64_t> next_update_; // [cell], in units
    std::vector<int64_t> sent_at_;     // [cell], when it began the message that is on its way, in units
    std::vector<Sides> on_the_way_;    // [cell], the sides where that has not arrived
    std::vector<uint8_t> sends_seed_;  // [cell], whether it is the seed state
    std::vector<int32_t> now_due_;     // those whose event is now
    std::vector<int32_t> running_;     // those whose neighbours have their message before the first tick
};

} // namespace tilenca
