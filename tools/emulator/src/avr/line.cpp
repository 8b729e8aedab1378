#include "avr/line.h"

#include <algorithm>

namespace tilenca::avr {

void Line::push(uint64_t cycle, Drive drive) {
    if (held_) {
        released_ = drive;
    } else {
        put(cycle, drive);
    }
}

void Line::put(uint64_t cycle, Drive drive) {
    while (edges() != 0 && changes_.back().cycle >= cycle) {
        changes_.pop_back();
    }
    if (before(changes_.size()) != drive) {
        changes_.push_back({cycle, drive});
    }
}

void Line::hold(uint64_t cycle, std::optional<bool> level) {
    if (level) {
        released_ = held_ ? released_ : before(changes_.size());
        held_ = true;
        put(cycle, drive_of(*level));
    } else if (held_) {
        held_ = false;
        put(cycle, released_);
    }
}

// Whoever asks, asks about the present or just before: the changes in question are the last ones.
size_t Line::first_from(uint64_t cycle) const {
    size_t i = changes_.size();
    while (i != first_ && changes_[i - 1].cycle >= cycle) {
        i--;
    }
    return i;
}

Drive Line::drive_at(uint64_t cycle) const {
    return before(first_from(cycle + 1));
}

std::optional<Line::Edge> Line::next_after(uint64_t cycle) const {
    const size_t next = first_from(cycle + 1);
    const Drive drive = before(next);
    const uint64_t end = next == changes_.size() ? kNever : changes_[next].cycle;
    if (is_noisy(drive)) {
        const uint64_t change = noise_->next_change(pin_.port, pin_.mask(), cycle, end);
        if (change != kNever) {
            return Edge{change, noise_->level(pin_, change), true};
        }
    }
    if (end == kNever) {
        return std::nullopt;
    }
    return Edge{end, level_of(changes_[next].drive, end), false};
}

std::optional<Line::Edge> Line::falling_from(uint64_t cycle) const {
    size_t next = first_from(cycle);
    if (next != changes_.size() && changes_[next].drive == Drive::Low && before(next) == Drive::High) {
        return Edge{changes_[next].cycle, false, false}; // as nearly always
    }
    uint64_t from = cycle == 0 ? 0 : cycle - 1;
    bool level = level_of(before(next), from);
    for (;;) {
        const std::optional<Edge> edge = next_after(from);
        if (!edge || (level && !edge->level && edge->cycle >= cycle)) {
            return edge;
        }
        from = edge->cycle;
        level = edge->level;
    }
}

void Line::forget_before(uint64_t cycle) {
    while (edges() != 0 && changes_[first_].cycle < cycle) {
        before_ = changes_[first_].drive;
        first_++;
    }
    if (first_ == changes_.size()) {
        changes_.clear();
        first_ = 0;
    } else if (first_ >= 64) {
        changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(first_));
        first_ = 0;
    }
}

void Line::state(Archive& archive) {
    changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
    archive(changes_, before_, pull_up_, held_, released_);
    for (size_t i = 0; i < changes_.size(); i++) {
        archive.require(changes_[i].cycle <= kLastCycle &&
                            (i == 0 || changes_[i - 1].cycle < changes_[i].cycle),
                        "a wire changes out of turn");
    }
}

} // namespace tilenca::avr
