#include "avr/gpio.h"

#include "avr/pin_registers.h"
#include "avr/registers.h"

namespace tilenca::avr {

Gpio::Gpio(const Core& core) : Peripheral(core) {
    for (unsigned i = 0; i < kPorts; i++) {
        ports_[i].base = static_cast<uint16_t>(i < 7 ? 0x20 + 3 * i : 0x100 + 3 * (i - 7));
        ports_[i].exist = kRegisters.implemented[ports_[i].base];
    }
}

std::vector<uint16_t> Gpio::registers() const {
    std::vector<uint16_t> all = {kPcifr, kEifr,   kEimsk,      kPcicr,     kEicra,
                                 kEicrb, kPcmsk0, kPcmsk0 + 1, kPcmsk0 + 2};
    for (const Port& port : ports_) {
        all.insert(all.end(),
                   {port.base, static_cast<uint16_t>(port.base + 1), static_cast<uint16_t>(port.base + 2)});
    }
    return all;
}

Gpio::Port* Gpio::port_of(uint16_t address, unsigned* which) {
    unsigned place = 0;
    if (address >= kPortsFirst && address < kPortsEnd) {
        place = address - kPortsFirst;
    } else if (address >= kFarPortsFirst && address < kFarPortsEnd) {
        place = address - kFarPortsFirst + (kPortsEnd - kPortsFirst);
    } else {
        return nullptr;
    }
    *which = place % 3;
    return &ports_[place / 3];
}

uint8_t Gpio::read(uint16_t address, uint64_t cycle) {
    unsigned which = 0;
    if (Port* port = port_of(address, &which); port != nullptr && which == 0) {
        return pins_as_read(*port, cycle);
    }
    return byte(address);
}

bool Gpio::reads_as_stored(uint16_t address) const {
    const bool is_near = address >= kPortsFirst && address < kPortsEnd;
    const bool is_pin = is_near || (address >= kFarPortsFirst && address < kFarPortsEnd);
    return !is_pin || (address - (is_near ? kPortsFirst : kFarPortsFirst)) % 3 != 0;
}

void Gpio::write(uint16_t address, uint8_t value, uint64_t cycle) {
    unsigned which = 0;
    if (address == kPcifr || address == kEifr) {
        byte(address) &= static_cast<uint8_t>(~value);
    } else if (Port* port = port_of(address, &which); port != nullptr) {
        port->written = cycle;
        port->ddr_before = ddr(*port);
        port->latch_before = latch(*port);
        if (which == 0) {
            latch(*port) ^= value; // a one written to PIN toggles PORT
        } else {
            byte(address) = value;
        }
        const unsigned changed = (ddr(*port) ^ port->ddr_before) | (latch(*port) ^ port->latch_before);
        shown_changes_ += (changed & port->shown) != 0;
        update(*port, cycle);
        return;
    } else {
        byte(address) = value;
        update_watched(cycle);
    }
    update_requests();
}

// PIN lags a cycle behind: in the cycle after a write, it still tells what was before. A program needs a NOP
// between the two, here as on the chip.
uint8_t Gpio::pins_as_read(Port& port, uint64_t cycle) {
    update(port, cycle);
    const bool too_soon = cycle == port.written + 1;
    const uint8_t levels =
        too_soon ? compute_levels(port, cycle, port.ddr_before, port.latch_before) : port.levels;
    return levels & port.exist;
}

uint8_t Gpio::compute_levels(Port& port, uint64_t cycle, uint8_t ddr, uint8_t latch) {
    uint8_t outside = port.held;
    for (unsigned lines = port.has_lines & ~ddr; lines != 0; lines &= lines - 1) {
        const int bit = __builtin_ctz(lines);
        outside &= static_cast<uint8_t>(~(!port.lines[bit]->level_at(cycle) << bit));
    }
    uint8_t driven = latch;
    const auto index = static_cast<uint8_t>(&port - ports_.data());
    for (unsigned taken = port.taken & ddr; taken != 0; taken &= taken - 1) {
        const auto bit = static_cast<uint8_t>(__builtin_ctz(taken));
        if (port.sources[bit] != nullptr) {
            bool high = port.sources[bit]->pin_level({index, bit}, cycle);
            if (port.modulators[bit] != nullptr) {
                const bool other = port.modulators[bit]->pin_level({index, bit}, cycle);
                high = (latch >> bit & 1) != 0 ? high || other : high && other;
            }
            driven = static_cast<uint8_t>((driven & ~(1 << bit)) | high << bit);
        }
    }
    return static_cast<uint8_t>((driven & ddr) | (outside & ~ddr));
}

void Gpio::update(Port& port, uint64_t cycle) {
    const uint8_t before = port.levels, after = compute_levels(port, cycle);
    if (before == after) {
        return;
    }
    port.levels = after;
    const auto index = static_cast<uint8_t>(&port - ports_.data());
    const auto changed = static_cast<uint8_t>(before ^ after);
    for (unsigned told = changed & port.watched_out; told != 0; told &= told - 1) {
        const auto bit = static_cast<uint8_t>(__builtin_ctz(told));
        // What a USART has taken over is announced by it alone.
        if ((port.taken >> bit & 1) == 0 || port.sources[bit] != nullptr) {
            tell({index, bit}, cycle, (after >> bit & 1) != 0);
        }
    }
    pins_changed(port, before, after, cycle);
}

void Gpio::announce(PinId pin, uint64_t cycle, bool level) {
    tell(pin, cycle, level);
}

void Gpio::tell(PinId pin, uint64_t cycle, bool level) {
    for (EdgeListener* listener : ports_[pin.port].listeners[pin.bit]) {
        listener->edge(pin, cycle, level);
    }
}

void Gpio::take_over(PinId pin, PinSource* source, bool as_output, uint64_t cycle) {
    Port& port = ports_[pin.port];
    update(port, cycle);
    if (as_output) {
        port.taken |= pin.mask();
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
    const bool was_silent = (port.taken & pin.mask()) != 0 && port.sources[pin.bit] == nullptr;
    PinSource *&first = port.sources[pin.bit], *&second = port.modulators[pin.bit];
    if (second != nullptr && source != nullptr) { // the other one stays
        first = first == source ? second : first;
    } else {
        port.taken &= static_cast<uint8_t>(~pin.mask());
        first = nullptr;
    }
    second = nullptr;
    note_shown(pin);
    update(port, cycle);
    if (was_silent) {
        announce(pin, cycle, level(pin, cycle));
    }
}

bool Gpio::level(PinId pin, uint64_t cycle) {
    update(ports_[pin.port], cycle);
    return (ports_[pin.port].levels >> pin.bit & 1) != 0;
}

bool Gpio::input_at(PinId pin, uint64_t cycle) const {
    const Port& port = ports_[pin.port];
    const bool held = (port.held >> pin.bit & 1) != 0;
    return held && (port.lines[pin.bit] == nullptr || port.lines[pin.bit]->level_at(cycle));
}

bool Gpio::is_output(PinId pin) const {
    return (byte(static_cast<uint16_t>(ports_[pin.port].base + 1)) >> pin.bit & 1) != 0;
}

bool Gpio::port_bit(PinId pin) const {
    return (byte(static_cast<uint16_t>(ports_[pin.port].base + 2)) >> pin.bit & 1) != 0;
}

void Gpio::reset(uint64_t cycle) {
    for (Port& port : ports_) {
        port.taken = port.interrupting = port.watched_in = port.watched = 0;
        port.watchers.fill(nullptr);
        port.sources.fill(nullptr);
        port.modulators.fill(nullptr);
        update(port, cycle);
    }
    note_watched_ports();
    core_.schedule.cancel(Slot::Lines);
}

void Gpio::state(Archive& archive) {
    for (Port& port : ports_) {
        archive(port.written, port.ddr_before, port.latch_before, port.levels, port.held, port.taken,
                port.interrupting, port.watched, port.watched_in, port.has_lines);
        for (unsigned bit = 0; bit < 8; bit++) {
            if ((port.has_lines >> bit & 1) != 0) {
                if (port.lines[bit] == nullptr) {
                    port.lines[bit] = std::make_unique<Line>();
                }
                archive(*port.lines[bit]);
            }
        }
        if (archive.loading()) { // they enter themselves again
            port.sources.fill(nullptr);
            port.modulators.fill(nullptr);
            port.watchers.fill(nullptr);
        }
    }
    archive(shown_changes_);
    note_watched_ports();
}

} // namespace tilenca::avr
