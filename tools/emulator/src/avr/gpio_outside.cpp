// Who looks at pins, and what comes in from outside.
#include "avr/gpio.h"

#include <algorithm>

namespace tilenca::avr {

Line& Gpio::attach_line(PinId pin) {
    Port& port = ports_[pin.port];
    port.lines[pin.bit] = std::make_unique<Line>();
    port.has_lines |= pin.mask();
    update_watched(core_.cpu.cycle);
    return *port.lines[pin.bit];
}

void Gpio::line_changed(PinId pin) {
    Port& port = ports_[pin.port];
    // An edge that is due and not served yet, since the array stopped just there, stays due.
    if ((port.watched_in & pin.mask()) != 0 && core_.schedule.due(Slot::Lines) > core_.cpu.cycle) {
        schedule_lines(core_.cpu.cycle);
    }
}

void Gpio::hold_input(PinId pin, bool level, uint64_t cycle) {
    Port& port = ports_[pin.port];
    port.held = static_cast<uint8_t>((port.held & ~pin.mask()) | level << pin.bit);
    update(port, cycle);
}

void Gpio::listen(PinId pin, EdgeListener* listener) {
    Port& port = ports_[pin.port];
    port.listeners[pin.bit].push_back(listener);
    port.watched_out |= pin.mask();
    update_watched(core_.cpu.cycle);
}

void Gpio::ignore(PinId pin, EdgeListener* listener) {
    Port& port = ports_[pin.port];
    auto& all = port.listeners[pin.bit];
    all.erase(std::remove(all.begin(), all.end(), listener), all.end());
    if (all.empty()) {
        port.watched_out &= static_cast<uint8_t>(~pin.mask());
    }
    update_watched(core_.cpu.cycle);
}

void Gpio::watch(PinId pin, PinWatcher* watcher, uint64_t cycle) {
    Port& port = ports_[pin.port];
    if (port.watchers[pin.bit] == watcher) {
        return;
    }
    port.watchers[pin.bit] = watcher;
    port.watched = static_cast<uint8_t>((port.watched & ~pin.mask()) | (watcher != nullptr) << pin.bit);
    update_watched(cycle);
}

bool Gpio::is_observed(PinId pin) const {
    const Port& port = ports_[pin.port];
    return ((port.interrupting | port.watched | port.watched_out) >> pin.bit & 1) != 0;
}

void Gpio::tell_sources() {
    for (Port& port : ports_) {
        for (unsigned bit = 0; port.taken >> bit != 0; bit++) {
            if (port.sources[bit] != nullptr) {
                port.sources[bit]->observers_changed();
            }
            if (port.modulators[bit] != nullptr) {
                port.modulators[bit]->observers_changed();
            }
        }
    }
}

} // namespace tilenca::avr
