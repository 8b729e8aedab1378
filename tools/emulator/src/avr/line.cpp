#include "avr/line.h"

#include <algorithm>

namespace tilenca::avr {

void Line::push(uint64_t cycle, bool level) {
    while (edges() != 0 && edges_.back().cycle >= cycle) {
        edges_.pop_back();
    }
    const bool last = edges() == 0 ? before_ : edges_.back().level;
    if (last != level) {
        edges_.push_back({cycle, level});
    }
}

// Whoever asks, asks about the present or just before: the edges in question are the last ones.
size_t Line::first_from(uint64_t cycle) const {
    size_t i = edges_.size();
    while (i != first_ && edges_[i - 1].cycle >= cycle) {
        i--;
    }
    return i;
}

bool Line::level_at(uint64_t cycle) const {
    const size_t next = first_from(cycle + 1);
    return next == first_ ? before_ : edges_[next - 1].level;
}

const Line::Edge* Line::next_after(uint64_t cycle) const {
    const size_t next = first_from(cycle + 1);
    return next == edges_.size() ? nullptr : &edges_[next];
}

const Line::Edge* Line::falling_from(uint64_t cycle) const {
    for (size_t i = first_from(cycle); i < edges_.size(); i++) {
        if (!edges_[i].level) {
            return &edges_[i];
        }
    }
    return nullptr;
}

void Line::forget_before(uint64_t cycle) {
    while (edges() != 0 && edges_[first_].cycle < cycle) {
        before_ = edges_[first_].level;
        first_++;
    }
    if (first_ == edges_.size()) {
        edges_.clear();
        first_ = 0;
    } else if (first_ >= 64) {
        edges_.erase(edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(first_));
        first_ = 0;
    }
}

void Line::state(Archive& archive) {
    edges_.erase(edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
    archive(edges_, before_);
}

} // namespace tilenca::avr
