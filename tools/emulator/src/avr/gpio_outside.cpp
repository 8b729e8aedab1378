// Who looks at pins, and what comes in from outside.
#include "avr/gpio.h"

#include <algorithm>

namespace tilenca::avr {

Line& Gpio::attach_line(PinId pin, Drive drive) {
    Port& port = ports_[pin.port];
    port.lines[pin.bit] = std::make_unique<Line>(noise_, pin, drive);
    port.lines[pin.bit]->set_pull_up((port.pulled & pin.mask()) != 0);
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

void Gpio::hold_input(PinId pin, std::optional<bool> level, uint64_t cycle) {
    Port& port = ports_[pin.port];
    if (Line* wire = line(pin); wire != nullptr) {
        wire->hold(cycle, level);
        line_was_changed_(pin);
        if ((port.watched_in & pin.mask()) != 0) {
            schedule_lines(cycle);
        }
    } else {
        port.driven = static_cast<uint8_t>((port.driven & ~pin.mask()) | level.has_value() << pin.bit);
        port.held = static_cast<uint8_t>((port.held & ~pin.mask()) | level.value_or(false) << pin.bit);
    }
    update(port, cycle);
}

void Gpio::listen(PinId pin, EdgeListener* listener) {
    Port& port = ports_[pin.port];
    port.listeners[pin.bit].push_back(listener);
    port.watched_out |= pin.mask();
    port.open = open_pins(port, port.watched_out, core_.cpu.cycle);
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

void Gpio::watch(PinId pin, PinWatcher* watcher, bool noise, uint64_t cycle) {
    Port& port = ports_[pin.port];
    const bool hears = noise && watcher != nullptr;
    if (port.watchers[pin.bit] == watcher && ((port.heard & pin.mask()) != 0) == hears) {
        return;
    }
    port.watchers[pin.bit] = watcher;
    port.watched = static_cast<uint8_t>((port.watched & ~pin.mask()) | (watcher != nullptr) << pin.bit);
    port.heard = static_cast<uint8_t>((port.heard & ~pin.mask()) | hears << pin.bit);
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
