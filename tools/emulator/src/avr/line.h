// One wire over time, as an input sees it: what was, and what is already on its way.
#pragma once

#include "avr/noise.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace tilenca::avr {

class Line {
  public:
    struct Edge {
        uint64_t cycle;
        bool level;
        bool is_noise; // nobody made it: it is known ahead of time only while nobody drives the wire
    };

    // An idle line, which somebody drives high.
    Line() = default;
    // The wire of an input; `noise` is what it reads while nobody drives it.
    Line(const Noise& noise, PinId pin, Drive drive) : noise_(&noise), pin_(pin), before_(drive) {}

    // From `cycle` on the wire is driven so; whatever was to come at or after `cycle` does not happen.
    void push(uint64_t cycle, Drive drive);
    // A finger or a short circuit holds the wire from `cycle` on, whatever else drives it. Nothing: it lets
    // go.
    void hold(uint64_t cycle, std::optional<bool> level);
    // The input's pull-up is on. It counts for the past, too, where nobody drove the wire.
    void set_pull_up(bool on) { pull_up_ = on; }

    Drive drive_at(uint64_t cycle) const;
    bool level_at(uint64_t cycle) const { return level_of(drive_at(cycle), cycle); }

    // The same for one moment after the other, at the cost of one look at each edge.
    class Levels {
      public:
        explicit Levels(const Line& line) : line_(line), next_(line.first_), drive_(line.before_) {}
        // `cycle` must not lie before that of the last call.
        bool at(uint64_t cycle) {
            while (next_ < line_.changes_.size() && line_.changes_[next_].cycle <= cycle) {
                drive_ = line_.changes_[next_++].drive;
            }
            return line_.level_of(drive_, cycle);
        }
        // Whether the level of the last call is also that of `cycle`.
        bool stays_until(uint64_t cycle) const {
            return (next_ == line_.changes_.size() || line_.changes_[next_].cycle > cycle) &&
                   !line_.is_noisy(drive_);
        }

      private:
        const Line& line_;
        size_t next_;
        Drive drive_;
    };

    // The first edge after `cycle`, if any is known.
    std::optional<Edge> next_after(uint64_t cycle) const;

    // The first edge to low at or after `cycle`, if any is known.
    std::optional<Edge> falling_from(uint64_t cycle) const;

    // Drops the history before `cycle`.
    void forget_before(uint64_t cycle);

    size_t edges() const { return changes_.size() - first_; }
    void state(Archive& archive);

  private:
    struct Change {
        uint64_t cycle;
        Drive drive;
        void state(Archive& archive) { archive(cycle, drive); }
    };

    bool is_noisy(Drive drive) const {
        return !is_driven(drive) && noise_ != nullptr && noise_->is_on() &&
               !(drive == Drive::Open && pull_up_);
    }
    bool level_of(Drive drive, uint64_t cycle) const {
        return is_driven(drive) ? drive == Drive::High : !is_noisy(drive) || noise_->level(pin_, cycle);
    }
    // Index of the first change at or after `cycle`.
    size_t first_from(uint64_t cycle) const;
    Drive before(size_t index) const { return index == first_ ? before_ : changes_[index - 1].drive; }
    void put(uint64_t cycle, Drive drive);

    const Noise* noise_ = nullptr;
    PinId pin_{};
    std::vector<Change> changes_; // rising times, from index first_ on
    size_t first_ = 0;
    Drive before_ = Drive::High; // before the first change
    bool pull_up_ = false;
    bool held_ = false;
    Drive released_ = Drive::High; // what drives it but for the hold
};

} // namespace tilenca::avr
