// Several turns of all tiles, on several threads, with no barrier between the turns.
//
// A tile may begin a turn as soon as its neighbours have ended all turns before: then all that reaches it is
// there, and nobody reads the list any more that it is going to write. So a tile that has much to do in one
// turn, and little in the next, holds up nobody but its neighbours. Each thread has tiles of its own, which
// stay in its caches; one that finds none of them ready for long takes those of another, which may have lost
// its processor.
#pragma once

#include "array/workers.h"

#include <atomic>
#include <functional>
#include <memory>
#include <vector>

namespace tilenca {

class Wave {
  public:
    // `threads` counts the caller's; `run_turn` is called with a tile and the number of its turn.
    Wave(unsigned threads, std::function<void(unsigned, unsigned)> run_turn);

    // So many turns of each tile; `neighbours` has those of each. What a turn throws, this throws.
    void run(const std::vector<std::vector<unsigned>>& neighbours, unsigned turns);
    // Until the next call of `run` the other threads need not look out for work so often.
    void rest() { workers_.rest(); }

  private:
    struct alignas(64) Progress {
        std::atomic<unsigned> ended{0}; // turns
        std::atomic<bool> is_taken{false};
    };

    void work(unsigned thread);
    // Whether any of these tiles had a turn.
    bool advance(unsigned begin, unsigned end);
    bool advance(unsigned tile);
    bool help_out();
    bool is_ready(unsigned tile, unsigned turn) const;

    const unsigned threads_;
    const std::function<void(unsigned, unsigned)> run_turn_;
    unsigned tiles_ = 0, turns_ = 0;
    const std::vector<std::vector<unsigned>>* neighbours_ = nullptr;
    std::unique_ptr<Progress[]> progress_;
    alignas(64) std::atomic<unsigned> unfinished_{0}; // tiles
    std::atomic<bool> has_failed_{false};
    Workers workers_; // last: its threads end first
};

} // namespace tilenca
