#include "array/wire.h"

#include <algorithm>

namespace tilenca {

namespace {

constexpr double kUnknownBaud = 38400;

} // namespace

Wire::Wire(Tile& from, Tile& to, End from_end, End to_end, const double& delay, const unsigned& writing)
    : from_(from), to_(to), from_end_(from_end), to_end_(to_end),
      from_pin_(Tile::transmit_pin(from_end.side)), to_pin_(Tile::receive_pin(to_end.side)), latency_(delay),
      writing_(writing) {
    if (to_.chip().gpio().line(to_pin_) == nullptr) {
        to_.chip().gpio().attach_line(to_pin_);
    }
    from_.chip().gpio().listen(from_pin_, this);
}

Wire::~Wire() {
    from_.chip().gpio().ignore(from_pin_, this);
}

void Wire::edge(avr::PinId, uint64_t cycle, bool level) {
    const double ticks = from_.clock().to_ticks(cycle);
    if (!connected_) {
        return;
    }
    if (!fault_.harms()) {
        sent_[writing_].push_back({ticks + latency_ + fault_.delay, level});
        return;
    }
    while (!raw_.empty() && raw_.back().ticks >= ticks) {
        raw_.pop_back();
    }
    raw_.push_back({ticks, level});
}

// An input at the end of a cable that leads nowhere reads high.
void Wire::set_connected(bool connected, double now) {
    if (connected == connected_) {
        return;
    }
    connected_ = connected;
    raw_.clear();
    border_ = kNoByte;
    muted_ = flipping_ = false;
    const bool idle = from_.bit_ticks(from_pin_) != 0; // a USART's line, but for the frame that is being sent
    raw_level_ = out_level_ =
        !connected || idle || from_.chip().gpio().level(from_pin_, from_.chip().cpu().cycle);
    sent_[writing_].push_back({now + latency_, out_level_});
}

void Wire::set_fault(const WireFault& fault, uint64_t seed) {
    fault_ = fault;
    random_ = avr::Random(seed);
    if (!fault.harms()) {
        for (const Edge& edge : raw_) {
            sent_[writing_].push_back({edge.ticks + latency_ + fault.delay, edge.level});
        }
        raw_.clear();
    }
}

double Wire::bit_ticks() {
    if (fault_.baud > 0) {
        return kTicksPerSecond / fault_.baud;
    }
    const double own = from_.bit_ticks(from_pin_), others = to_.bit_ticks(to_pin_);
    return own > 0 ? own : (others > 0 ? others : kTicksPerSecond / kUnknownBaud);
}

void Wire::start_byte(double ticks) {
    start_ = ticks;
    bit_ = bit_ticks();
    border_ = 1;
    counts_.bytes++;
    muted_ = random_.uniform() < fault_.loss;
    counts_.lost += muted_;
    flips_ = 0;
    for (unsigned bit = 0; bit < 8; bit++) {
        flips_ |= static_cast<uint8_t>((random_.uniform() < fault_.flip) << bit);
    }
    if (!muted_) {
        counts_.flipped += static_cast<unsigned>(__builtin_popcount(flips_));
    }
}

// Bits begin at borders 1 (lowest) to 9 (stop bit); the byte is over in the middle of its stop bit.
void Wire::pass_borders(double until) {
    while (border_ != kNoByte) {
        const double when = start_ + bit_ * (border_ == kLastBorder ? 9.5 : border_);
        if (when >= until) {
            return;
        }
        flipping_ = border_ < 9 && (flips_ >> (border_ - 1) & 1) != 0;
        if (border_ == kLastBorder) {
            muted_ = false;
            border_ = kNoByte;
        } else {
            border_++;
        }
        send(when);
    }
}

void Wire::send(double ticks) {
    const bool level = muted_ || raw_level_ != flipping_;
    if (level != out_level_) {
        out_level_ = level;
        sent_[writing_].push_back({ticks + latency_ + fault_.delay, level});
    }
}

void Wire::settle(double end) {
    for (; !raw_.empty() && raw_.front().ticks < end; raw_.pop_front()) {
        const Edge edge = raw_.front();
        pass_borders(edge.ticks);
        if (edge.level == raw_level_) {
            continue;
        }
        raw_level_ = edge.level;
        if (!edge.level && border_ == kNoByte) {
            start_byte(edge.ticks);
        }
        send(edge.ticks);
    }
    pass_borders(end);
}

double Wire::pending() const {
    if (!sent_[writing_].empty()) {
        return 0;
    }
    const double border = border_ == kNoByte ? HUGE_VAL : start_ + bit_ * border_;
    return raw_.empty() ? border : std::min(border, raw_.front().ticks);
}

bool Wire::hand_over() {
    std::vector<Edge>& edges = sent_[1 - writing_];
    for (const Edge& edge : edges) {
        to_.chip().push_edge(to_pin_, to_.clock().to_cycle(edge.ticks), edge.level);
    }
    edges.clear();
    return true;
}

void Wire::state(avr::Archive& archive) {
    std::vector<Edge> raw(raw_.begin(), raw_.end());
    archive(sent_[writing_], sent_[1 - writing_], connected_, fault_.loss, fault_.flip, fault_.delay,
            fault_.baud, random_, counts_.bytes, counts_.lost, counts_.flipped, raw, raw_level_, out_level_,
            muted_, flipping_, flips_, start_, bit_, border_);
    raw_.assign(raw.begin(), raw.end());
}

} // namespace tilenca
