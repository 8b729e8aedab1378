// Observers of one pin: its edges with their times, and the bytes that the edges make. Their pull-up lifts a
// pin that floats.
#pragma once

#include "avr/gpio.h"
#include "tile/serial_receiver.h"

namespace tilenca {

class Probe : public avr::EdgeListener {
  public:
    struct Edge {
        double ticks;
        bool level;
    };

    Probe(const Clock& clock, avr::PinId pin, bool level) : clock_(clock), pin_(pin), level_(level) {}

    avr::PinId pin() const { return pin_; }
    // With a rate it reads bytes instead of keeping edges.
    void read_bytes(double baud);
    bool reads_bytes() const { return reads_bytes_; }
    SerialReceiver& receiver() { return receiver_; }
    void set_follows(bool follows) { follows_ = follows; }
    bool follows() const { return follows_; }

    void edge(avr::PinId pin, uint64_t cycle, bool level, bool open) override;
    // All before `end` is certain.
    void settle(double end);
    std::deque<Edge>& edges() { return settled_; }
    // The level before the first edge that was not taken away yet.
    bool level() const { return level_; }
    void note_taken(const Edge& edge) { level_ = edge.level; }
    // A restored array is at another time: what was to come is gone.
    void restart(bool level);

  private:
    const Clock& clock_;
    avr::PinId pin_;
    bool level_;
    bool reads_bytes_ = false, follows_ = false;
    SerialReceiver receiver_;
    std::deque<Edge> pending_, settled_;
};

} // namespace tilenca
