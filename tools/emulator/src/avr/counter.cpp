#include "avr/counter.h"

#include <algorithm>

namespace tilenca::avr {

void Counter::reset() {
    *this = Counter(max_, channels_);
}

uint16_t Counter::top() const {
    switch (mode_.top) {
    case Top::CompareA:
        return compares_[0];
    case Top::Capture:
        return capture_;
    default:
        return mode_.fixed_top;
    }
}

uint64_t Counter::period() const {
    const uint64_t last = top();
    return is_two_way() ? std::max<uint64_t>(2 * last, 1) : last + 1;
}

void Counter::set_mode(const WaveMode& mode) {
    mode_ = mode;
    free_ticks_ = 0;
    if (!is_pwm()) {
        load_buffers();
    }
    down_ = down_ && is_two_way();
}

void Counter::set_count(uint16_t count) {
    count_ = count;
    free_ticks_ = 0;
    blocked_ = true;
}

void Counter::set_compare(unsigned channel, uint16_t value) {
    buffers_[channel] = value;
    if (!is_pwm()) {
        compares_[channel] = value;
        free_ticks_ = 0;
    }
}

uint64_t Counter::ticks_to_boundary() const {
    uint64_t soonest = down_ ? count_ + 1u : max_ - count_ + 1u;
    const auto consider = [&](uint16_t value) {
        if (!down_ && value >= count_) {
            soonest = std::min<uint64_t>(soonest, value - count_ + 1u);
        } else if (down_ && value <= count_) {
            soonest = std::min<uint64_t>(soonest, count_ - value + 1u);
        }
    };
    for (unsigned channel = 0; channel < channels_; channel++) {
        consider(compares_[channel]);
    }
    if (!down_) {
        consider(top());
    }
    return soonest;
}

// Whether every period from here on is like the next, until somebody writes a register. A buffered value that
// waits could change the top, and with it the period itself.
bool Counter::is_settled() const {
    return count_ <= top() && (!is_pwm() || compares_ == buffers_);
}

// Whether nothing but flags comes of counting up to the top and on from zero.
bool Counter::only_sets_flags() const {
    return mode_.wave == Wave::Fast && !blocked_ && is_settled() && !toggles(0) && !toggles(1) && !toggles(2);
}

// At most a period of those.
void Counter::advance_plainly(uint64_t ticks) {
    const unsigned last = top(), first = count_;
    const auto passes = [=](unsigned value) {
        return value <= last && (value >= first ? value - first : value + last + 1 - first) < ticks;
    };
    for (unsigned channel = 0; channel < channels_; channel++) {
        flags |= static_cast<uint8_t>(passes(compares_[channel]) << channel << 1); // from kFlagCompareA on
    }
    if (passes(last)) {
        flags |= kFlagOverflow | (mode_.top == Top::Capture ? kFlagCapture : 0);
    }
    const uint64_t count = first + ticks;
    count_ = static_cast<uint16_t>(count > last ? count - last - 1 : count);
    free_ticks_ = 0;
}

void Counter::advance_far(uint64_t ticks) {
    if (only_sets_flags() && ticks <= period()) {
        return advance_plainly(ticks);
    }
    if (ticks == free_ticks_ && ticks != 0) { // as most events are: just there
        step(ticks);
        free_ticks_ = static_cast<uint32_t>(ticks_to_boundary());
        return;
    }
    while (ticks != 0 && !is_settled()) {
        ticks -= step(ticks);
    }
    // Two periods set every flag that can be set, and an output that toggles ends as it began: however many
    // pairs of periods follow, they change nothing.
    const uint64_t pair = 2 * period();
    if (ticks > 2 * pair) {
        ticks = pair + ticks % pair;
    }
    while (ticks != 0) {
        ticks -= step(ticks);
    }
    free_ticks_ = static_cast<uint32_t>(ticks_to_boundary());
}

// Runs to the next value at which anything can happen and leaves it, or as far as `ticks` go; returns the
// ticks taken.
uint64_t Counter::step(uint64_t ticks) {
    const uint64_t whole = free_ticks_ != 0 ? free_ticks_ : ticks_to_boundary();
    free_ticks_ = 0;
    const uint64_t taken = std::min(whole, ticks);
    const auto passed = static_cast<uint16_t>(taken == whole ? whole - 1 : taken);
    count_ = static_cast<uint16_t>(down_ ? count_ - passed : count_ + passed);
    blocked_ = blocked_ && passed == 0;
    if (taken == whole) {
        leave();
    }
    return taken;
}

// The tick that leaves the present value.
void Counter::leave() {
    for (unsigned channel = 0; channel < channels_; channel++) {
        if (compares_[channel] == count_ && !blocked_) {
            flags |= static_cast<uint8_t>(kFlagCompareA << channel);
            if (!is_pwm() || toggles(channel)) {
                act(channel);
            }
        }
    }
    blocked_ = false;
    turn_or_wrap(top());
}

void Counter::turn_or_wrap(uint16_t top) {
    if (down_) {
        if (count_ == 0) {
            flags |= kFlagOverflow;
            down_ = false;
            if (mode_.wave == Wave::PhaseAndFrequencyCorrect) {
                load_buffers();
            }
            count_ = this->top() == 0 ? 0 : 1;
        } else {
            count_--;
        }
        return;
    }
    const bool at_top = count_ == top && mode_.wave != Wave::Normal;
    if (at_top && mode_.top == Top::Capture) {
        flags |= kFlagCapture;
    }
    if (is_two_way() && (at_top || count_ == max_)) {
        down_ = true;
        if (mode_.wave == Wave::PhaseCorrect) {
            load_buffers();
        }
        count_ = static_cast<uint16_t>(count_ == 0 ? 0 : count_ - 1);
    } else if (at_top || count_ == max_) {
        if (mode_.wave == Wave::Fast) {
            flags |= at_top ? kFlagOverflow : 0;
            load_buffers();
        } else if (count_ == max_) {
            flags |= kFlagOverflow;
        }
        count_ = 0;
    } else {
        count_++;
    }
}

void Counter::act(unsigned channel) {
    switch (actions_[channel]) {
    case 1:
        levels_[channel] = !levels_[channel];
        break;
    case 2:
        levels_[channel] = false;
        break;
    case 3:
        levels_[channel] = true;
        break;
    default:
        break;
    }
}

uint64_t Counter::ticks_to_leave(uint16_t value, bool either_way) const {
    const uint64_t last = top();
    if (count_ > last) { // beyond its top the counter first runs on to its end
        const uint64_t to_zero = is_two_way() ? count_ : max_ - count_ + 1u;
        return !is_two_way() && value >= count_ ? value - count_ + 1u : to_zero + 1;
    }
    if (value > last) {
        return 0;
    }
    if (!is_two_way()) {
        return (value >= count_ ? value - count_ : last + 1 - count_ + value) + 1;
    }
    const uint64_t whole = period(), position = down_ ? (2 * last - count_) % whole : count_;
    const uint64_t rising = (value + whole - position) % whole,
                   falling = (2 * whole - value - position) % whole;
    return (either_way ? std::min(rising, falling) : rising) + 1;
}

uint64_t Counter::ticks_to_reload() const {
    if (!is_pwm() || compares_ == buffers_) {
        return 0;
    }
    return ticks_to_leave(mode_.wave == Wave::PhaseAndFrequencyCorrect ? 0 : top(), true);
}

uint64_t Counter::ticks_to_flag(uint8_t mask) const {
    uint64_t soonest = 0;
    const auto consider = [&soonest](uint64_t ticks) {
        if (ticks != 0 && (soonest == 0 || ticks < soonest)) {
            soonest = ticks;
        }
    };
    for (unsigned channel = 0; channel < channels_; channel++) {
        if ((mask & kFlagCompareA << channel) != 0) {
            consider(ticks_to_leave(compares_[channel], true));
        }
    }
    if ((mask & kFlagOverflow) != 0) {
        const bool at_max = mode_.wave == Wave::Normal || mode_.wave == Wave::Ctc;
        consider(ticks_to_leave(is_two_way() ? 0 : (at_max ? max_ : top()), true));
    }
    if ((mask & kFlagCapture) != 0 && mode_.top == Top::Capture) {
        consider(ticks_to_leave(capture_, true));
    }
    consider(ticks_to_reload());
    return soonest;
}

bool Counter::level(unsigned channel) const {
    if (!is_pwm() || toggles(channel)) {
        return levels_[channel];
    }
    const bool high = is_two_way() ? count_ < compares_[channel] : count_ <= compares_[channel];
    return high == (actions_[channel] == 2);
}

double Counter::duty(unsigned channel) const {
    if (toggles(channel)) {
        return 0.5;
    }
    if (!is_pwm()) {
        return levels_[channel] ? 1.0 : 0.0;
    }
    const double last = top();
    const double value = std::min<double>(compares_[channel], last);
    const double high = is_two_way() ? (last == 0 ? 0.0 : value / last) : (value + 1) / (last + 1);
    return actions_[channel] == 2 ? high : 1.0 - high;
}

// Where the register is the top, there is nothing to capture into.
void Counter::capture_now() {
    if (mode_.top != Top::Capture) {
        capture_ = count_;
        flags |= kFlagCapture;
    }
}

void Counter::state(Archive& archive) {
    archive(mode_.wave, mode_.top, mode_.fixed_top, count_, capture_, down_, blocked_, compares_, buffers_,
            actions_, levels_, flags);
    uint16_t greatest = std::max(count_, mode_.fixed_top);
    for (unsigned channel = 0; channel < channels_; channel++) {
        greatest = std::max({greatest, compares_[channel], buffers_[channel]});
        archive.require(actions_[channel] <= 3, "an output does what none does");
    }
    archive.require(greatest <= max_ && (max_ > 0xFF || mode_.top != Top::Capture),
                    "a timer counts further than it can");
    free_ticks_ = 0;
}

} // namespace tilenca::avr
