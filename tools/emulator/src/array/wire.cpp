#include "array/wire.h"

#include <algorithm>

namespace tilenca {

using avr::Drive;

namespace {

constexpr double kUnknownBaud = 38400;

} // namespace

Wire::Wire(Tile& from, Tile& to, End from_end, End to_end, const Common& common, double now)
    : from_(from), to_(to), from_end_(from_end), to_end_(to_end),
      from_pin_(Tile::transmit_pin(from_end.side)), to_pin_(Tile::receive_pin(to_end.side)), common_(common) {
    if (!to_.chip().gpio().has_line(to_pin_)) {
        to_.chip().gpio().attach_line(to_pin_, Drive::Open);
    }
    from_.chip().gpio().listen(from_pin_, this);
    drive_anew(now);
}

Wire::~Wire() {
    from_.chip().gpio().ignore(from_pin_, this);
}

void Wire::edge(avr::PinId, uint64_t cycle, bool level, bool open) {
    const double ticks = from_.clock().to_ticks(cycle);
    if (!connected_ || !from_.is_powered()) {
        return;
    }
    const Drive drive = open ? Drive::Open : avr::drive_of(level);
    if (!fault_.harms()) {
        put(ticks + common_.delay + fault_.delay, drive);
        return;
    }
    while (!raw_.empty() && raw_.back().ticks >= ticks) {
        raw_.pop_back();
    }
    raw_.push_back({ticks, drive});
}

void Wire::set_connected(bool connected, double now) {
    if (connected != connected_) {
        connected_ = connected;
        drive_anew(now);
    }
}

// Says what the wire is driven like from now on, whatever was on its way. A cable that leads nowhere is open.
// So is the pin of a tile that has just got its power; until then the tile loads the wire.
void Wire::drive_anew(double now) {
    raw_.clear();
    border_ = kNoByte;
    muted_ = flipping_ = false;
    const bool is_on = from_.is_on(now);
    Drive drive = Drive::Open;
    if (connected_) {
        // A USART's line is idle, but for the frame that is being sent.
        drive = is_on ? from_.chip().gpio().drive(from_pin_, from_.chip().cpu().cycle) : common_.unpowered;
    }
    raw_drive_ = out_drive_ = drive;
    put(now + common_.delay, drive);
    if (connected_ && !is_on && from_.is_powered()) {
        raw_drive_ = out_drive_ = Drive::Open;
        put(from_.clock().to_ticks(0) + common_.delay, Drive::Open);
    }
}

void Wire::set_fault(const WireFault& fault, uint64_t seed) {
    if (fault.harms() && !fault_.harms() && connected_ && from_.is_powered()) {
        raw_drive_ = out_drive_ = from_.chip().gpio().drive(from_pin_, from_.chip().cpu().cycle);
    }
    fault_ = fault;
    random_ = avr::Random(seed);
    others_bit_[0] = others_bit_[1] = to_.bit_ticks(to_pin_);
    if (!fault.harms()) {
        for (const Edge& edge : raw_) {
            put(edge.ticks + common_.delay + fault.delay, edge.drive);
        }
        raw_.clear();
    }
}

double Wire::bit_ticks() {
    if (fault_.baud > 0) {
        return kTicksPerSecond / fault_.baud;
    }
    const double own = from_.bit_ticks(from_pin_), others = others_bit_[1 - from_.list()];
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
    Drive drive = muted_ ? Drive::High : raw_drive_;
    if (flipping_ && avr::is_driven(raw_drive_) && !muted_) {
        drive = avr::drive_of(raw_drive_ == Drive::Low);
    }
    if (drive != out_drive_) {
        out_drive_ = drive;
        put(ticks + common_.delay + fault_.delay, drive);
    }
}

void Wire::settle(double end) {
    for (; !raw_.empty() && raw_.front().ticks < end; raw_.pop_front()) {
        const Edge edge = raw_.front();
        pass_borders(edge.ticks);
        if (edge.drive == raw_drive_) {
            continue;
        }
        raw_drive_ = edge.drive;
        if (edge.drive == Drive::Low && border_ == kNoByte) {
            start_byte(edge.ticks);
        }
        send(edge.ticks);
    }
    pass_borders(end);
}

double Wire::pending() const {
    if (!sent_[from_.list()].edges.empty()) {
        return 0;
    }
    const double border = border_ == kNoByte ? HUGE_VAL : start_ + bit_ * border_;
    return raw_.empty() ? border : std::min(border, raw_.front().ticks);
}

bool Wire::hand_over() {
    std::vector<Edge>& edges = sent_[1 - to_.list()].edges;
    for (const Edge& edge : edges) {
        to_.chip().push_edge(to_pin_, to_.clock().to_cycle(edge.ticks), edge.drive);
    }
    edges.clear();
    return true;
}

void Wire::state(avr::Archive& archive) {
    std::vector<Edge> raw(raw_.begin(), raw_.end());
    const unsigned list = from_.list(); // between turns all tiles have the same
    archive(sent_[list].edges, sent_[1 - list].edges, connected_, fault_.loss, fault_.flip, fault_.delay,
            fault_.baud, random_, counts_.bytes, counts_.lost, counts_.flipped, raw, raw_drive_, out_drive_,
            muted_, flipping_, flips_, start_, bit_, border_, others_bit_[list], others_bit_[1 - list]);
    archive.require(border_ <= kLastBorder && (border_ == kNoByte || bit_ > 0),
                    "a cable carries no byte that is");
    archive.require(fault_.loss >= 0 && fault_.loss <= 1 && fault_.flip >= 0 && fault_.flip <= 1 &&
                        fault_.delay >= 0 && fault_.delay <= kTicksPerSecond && fault_.baud >= 0 &&
                        others_bit_[0] >= 0 && others_bit_[1] >= 0,
                    "a cable has a fault that none can have");
    raw_.assign(raw.begin(), raw.end());
}

} // namespace tilenca
