#include "tile/probe.h"

namespace tilenca {

void Probe::read_bytes(double baud) {
    reads_bytes_ = true;
    if (baud > 0) {
        receiver_.set_baud(baud);
    }
    follows_ = baud <= 0;
}

void Probe::edge(avr::PinId, uint64_t cycle, bool level, bool open) {
    level = level || open;
    const double ticks = clock_.to_ticks(cycle);
    if (reads_bytes_) {
        receiver_.edge(ticks, level);
        return;
    }
    while (!pending_.empty() && pending_.back().ticks >= ticks) {
        pending_.pop_back();
    }
    pending_.push_back({ticks, level});
}

void Probe::settle(double end) {
    if (reads_bytes_) {
        receiver_.receive_until(end);
        return;
    }
    for (; !pending_.empty() && pending_.front().ticks < end; pending_.pop_front()) {
        const bool last = settled_.empty() ? level_ : settled_.back().level;
        if (pending_.front().level != last) {
            settled_.push_back(pending_.front());
        }
    }
}

void Probe::restart(bool level) {
    pending_.clear();
    settled_.clear();
    level_ = level;
    receiver_ = SerialReceiver();
}

} // namespace tilenca
