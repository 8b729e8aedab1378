// The level of one wire over time, as an input sees it: what was, and what is already on its way.
#pragma once

#include "avr/archive.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tilenca::avr {

class Line {
  public:
    struct Edge {
        uint64_t cycle;
        bool level;
        void state(Archive& archive) { archive(cycle, level); }
    };

    // From `cycle` on the wire has this level; whatever was to come at or after `cycle` does not happen.
    void push(uint64_t cycle, bool level);

    bool level_at(uint64_t cycle) const;

    // The same for one moment after the other, at the cost of one look at each edge.
    class Levels {
      public:
        explicit Levels(const Line& line) : line_(line), next_(line.first_), level_(line.before_) {}
        // `cycle` must not lie before that of the last call.
        bool at(uint64_t cycle) {
            while (next_ < line_.edges_.size() && line_.edges_[next_].cycle <= cycle) {
                level_ = line_.edges_[next_++].level;
            }
            return level_;
        }
        // Whether the level of the last call is also that of `cycle`.
        bool stays_until(uint64_t cycle) const {
            return next_ == line_.edges_.size() || line_.edges_[next_].cycle > cycle;
        }

      private:
        const Line& line_;
        size_t next_;
        bool level_;
    };

    // The first edge after `cycle`, or null.
    const Edge* next_after(uint64_t cycle) const;

    // The first edge to low at or after `cycle`, or null.
    const Edge* falling_from(uint64_t cycle) const;

    // Drops the history before `cycle`.
    void forget_before(uint64_t cycle);

    size_t edges() const { return edges_.size() - first_; }
    void state(Archive& archive);

  private:
    // Index of the first edge at or after `cycle`.
    size_t first_from(uint64_t cycle) const;

    std::vector<Edge> edges_; // alternating levels, rising times, from index first_ on
    size_t first_ = 0;
    bool before_ = true; // the level before the first edge; an idle line is high
};

} // namespace tilenca::avr
