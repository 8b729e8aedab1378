// What pins do to the world outside, and the parts of the chip that take them from their ports.
#include "avr/gpio.h"

namespace tilenca::avr {

Drive Gpio::drive(PinId pin, uint64_t cycle) {
    Port& port = ports_[pin.port];
    update(port, cycle);
    if ((port.silent & pin.mask()) != 0) {
        return Drive::High; // an idle line; its USART announces the rest
    }
    return open_pins(port, pin.mask(), cycle) != 0 ? Drive::Open : drive_of((port.levels & pin.mask()) != 0);
}

void Gpio::tell(PinId pin, uint64_t cycle, bool level, bool open) {
    for (EdgeListener* listener : ports_[pin.port].listeners[pin.bit]) {
        listener->edge(pin, cycle, level, open);
    }
}

void Gpio::announce_port(PinId pin, uint64_t cycle) {
    Port& port = ports_[pin.port];
    update(port, cycle);
    tell(pin, cycle, (port.levels & pin.mask()) != 0, open_pins(port, pin.mask(), cycle) != 0);
}

void Gpio::take_over(PinId pin, PinSource* source, bool as_output, uint64_t cycle) {
    Port& port = ports_[pin.port];
    update(port, cycle);
    if (as_output) {
        port.taken |= pin.mask();
        port.silent |= source == nullptr ? pin.mask() : 0;
        drive_again(pin, source);
    }
    note_shown(pin);
    update(port, cycle);
}

void Gpio::drive_again(PinId pin, PinSource* source) {
    Port& port = ports_[pin.port];
    PinSource*& first = port.sources[pin.bit];
    (first == nullptr || first == source ? first : port.modulators[pin.bit]) = source;
}

void Gpio::release(PinId pin, uint64_t cycle, const PinSource* source) {
    Port& port = ports_[pin.port];
    const bool was_silent = (port.silent & pin.mask()) != 0;
    PinSource *&first = port.sources[pin.bit], *&second = port.modulators[pin.bit];
    if (second != nullptr && source != nullptr) { // the other one stays
        first = first == source ? second : first;
    } else {
        port.taken &= static_cast<uint8_t>(~pin.mask());
        port.silent &= static_cast<uint8_t>(~pin.mask());
        first = nullptr;
    }
    second = nullptr;
    note_shown(pin);
    update(port, cycle);
    if (was_silent) {
        announce_port(pin, cycle);
    }
}

} // namespace tilenca::avr
