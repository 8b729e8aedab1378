#include "array/wave.h"

#include "array/spin.h"

#include <thread>
#include <utility>

namespace tilenca {

Wave::Wave(unsigned threads, std::function<void(unsigned, unsigned)> run_turn)
    : threads_(threads), run_turn_(std::move(run_turn)),
      workers_(threads, [this](unsigned thread) { work(thread); }) {}

void Wave::run(const std::vector<std::vector<unsigned>>& neighbours, unsigned turns) {
    const auto tiles = static_cast<unsigned>(neighbours.size());
    if (progress_ == nullptr || tiles != tiles_) {
        progress_.reset(new Progress[tiles]);
        tiles_ = tiles;
    }
    for (unsigned i = 0; i < tiles; i++) {
        progress_[i].ended.store(0, std::memory_order_relaxed);
        progress_[i].is_taken.store(false, std::memory_order_relaxed);
    }
    neighbours_ = &neighbours;
    turns_ = turns;
    unfinished_.store(tiles, std::memory_order_relaxed);
    has_failed_.store(false, std::memory_order_relaxed);
    workers_.share(threads_); // which orders all of this before what the other threads do
}

void Wave::work(unsigned thread) {
    const auto begin = static_cast<unsigned>(uint64_t{thread} * tiles_ / threads_);
    const auto end = static_cast<unsigned>(uint64_t{thread + 1} * tiles_ / threads_);
    for (int idle = 0; unfinished_.load(std::memory_order_acquire) != 0;) {
        if (has_failed_.load(std::memory_order_relaxed)) {
            return;
        }
        if (advance(begin, end) || (idle >= kPatience && help_out())) {
            idle = 0;
        } else if (idle < kSpins) {
            idle++;
            relax();
        } else {
            std::this_thread::yield();
        }
    }
}

bool Wave::advance(unsigned begin, unsigned end) {
    bool any = false;
    for (unsigned tile = begin; tile < end; tile++) {
        any = advance(tile) || any;
    }
    return any;
}

// A turn of another thread's tile, of one that is most behind.
bool Wave::help_out() {
    unsigned most_behind = tiles_, least = turns_;
    for (unsigned tile = 0; tile < tiles_; tile++) {
        const unsigned ended = progress_[tile].ended.load(std::memory_order_relaxed);
        if (ended < least && !progress_[tile].is_taken.load(std::memory_order_relaxed)) {
            least = ended;
            most_behind = tile;
        }
    }
    return most_behind != tiles_ && advance(most_behind);
}

bool Wave::is_ready(unsigned tile, unsigned turn) const {
    for (const unsigned other : (*neighbours_)[tile]) {
        if (progress_[other].ended.load(std::memory_order_acquire) < turn) {
            return false;
        }
    }
    return turn < turns_;
}

bool Wave::advance(unsigned tile) {
    Progress& own = progress_[tile];
    // Looked at before it is taken: nearly always that is answer enough.
    if (!is_ready(tile, own.ended.load(std::memory_order_relaxed)) ||
        own.is_taken.load(std::memory_order_relaxed) ||
        own.is_taken.exchange(true, std::memory_order_acquire)) {
        return false;
    }
    unsigned turn = own.ended.load(std::memory_order_relaxed);
    const unsigned before = turn;
    try {
        for (; is_ready(tile, turn); turn++) {
            run_turn_(tile, turn);
            own.ended.store(turn + 1, std::memory_order_release);
        }
    } catch (...) {
        has_failed_ = true;
        throw;
    }
    own.is_taken.store(false, std::memory_order_release);
    if (turn == turns_ && turn != before) {
        unfinished_.fetch_sub(1, std::memory_order_release);
    }
    return turn != before;
}

} // namespace tilenca
