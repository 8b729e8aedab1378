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
        update_pull_ups(*port, cycle);
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
    const uint8_t levels = too_soon ? compute_levels(port, cycle, port.ddr_before, port.latch_before, 0xFF)
                                    : all_levels(port, cycle);
    return static_cast<uint8_t>(levels & port.exist & ~port.inputs_off);
}

// Of floating pins those in `noise_of` read noise; the others stay as they are known.
uint8_t Gpio::compute_levels(Port& port, uint64_t cycle, uint8_t ddr, uint8_t latch, uint8_t noise_of) {
    const uint8_t pulled = pull_ups(ddr, latch), floating = floating_pins(port, ddr, pulled);
    unsigned outside = (port.held & port.driven) | (pulled & ~port.driven);
    if (!noise_.is_on()) {
        outside |= floating;
    } else {
        outside |= floating & ~noise_of & port.levels;
        if ((floating & noise_of) != 0) {
            outside |= floating & noise_of & noise_.levels(index_of(port), cycle);
        }
    }
    for (unsigned lines = port.has_lines & ~ddr; lines != 0; lines &= lines - 1) {
        const int bit = __builtin_ctz(lines);
        outside = (outside & ~(1u << bit)) | unsigned{port.lines[bit]->level_at(cycle)} << bit;
    }
    uint8_t driven = latch;
    const uint8_t index = index_of(port);
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
    if (const uint8_t audible = audible_pins(port); audible != port.audible) {
        port.audible = audible;
        note_watched_ports();
        schedule_lines(cycle);
    }
    const uint8_t before = port.levels, after = compute_levels(port, cycle, port.audible);
    const uint8_t open = port.watched_out == 0 ? 0 : open_pins(port, port.watched_out, cycle);
    if (before == after && open == port.open) {
        return;
    }
    const unsigned changed = (before ^ after) | (open ^ port.open);
    port.levels = after;
    port.open = open;
    for (unsigned fell = before & ~after & port.remembered & port.ddr_before; fell != 0; fell &= fell - 1) {
        port.fell[static_cast<unsigned>(__builtin_ctz(fell))] = cycle;
    }
    // What a USART has taken over is announced by it alone.
    for (unsigned told = changed & port.watched_out & ~port.silent; told != 0; told &= told - 1) {
        const auto bit = static_cast<uint8_t>(__builtin_ctz(told));
        tell({index_of(port), bit}, cycle, (after >> bit & 1) != 0, (open >> bit & 1) != 0);
    }
    pins_changed(port, before, after, cycle);
}

// Floating pins whose edges could do something.
uint8_t Gpio::audible_pins(const Port& port) const {
    const unsigned listened = port.interrupting | port.heard;
    return listened == 0 || !noise_.is_on()
               ? 0
               : static_cast<uint8_t>(listened & floating_pins(port, ddr(port), port.pulled));
}

// Pins of a mask that nothing drives: neither the chip, nor its pull-up, nor anybody outside.
uint8_t Gpio::open_pins(const Port& port, uint8_t mask, uint64_t cycle) const {
    uint8_t open = floating_pins(port, ddr(port), port.pulled) & mask;
    for (unsigned lines = port.has_lines & ~ddr(port) & mask; lines != 0; lines &= lines - 1) {
        const int bit = __builtin_ctz(lines);
        const Drive drive = port.lines[bit]->drive_at(cycle);
        const bool is_pulled = (port.pulled >> bit & 1) != 0 && drive == Drive::Open;
        open |= static_cast<uint8_t>((!is_driven(drive) && !is_pulled) << bit);
    }
    return static_cast<uint8_t>(open & ~port.silent);
}

// As a program reads them, floating ones included.
uint8_t Gpio::all_levels(Port& port, uint64_t cycle) {
    if (!noise_.is_on()) {
        return port.levels;
    }
    const uint8_t rest = floating_pins(port, ddr(port), port.pulled) & ~port.audible;
    const uint8_t noise = rest == 0 ? 0 : noise_.levels(index_of(port), cycle);
    return static_cast<uint8_t>((port.levels & ~rest) | (noise & rest));
}

void Gpio::update_pull_ups(Port& port, uint64_t cycle) {
    const uint8_t pulled = pull_ups(ddr(port), latch(port));
    const unsigned changed = (pulled ^ port.pulled) & port.has_lines;
    port.pulled = pulled;
    for (unsigned lines = changed; lines != 0; lines &= lines - 1) {
        const auto bit = static_cast<uint8_t>(__builtin_ctz(lines));
        port.lines[bit]->set_pull_up((pulled >> bit & 1) != 0);
        line_was_changed_({index_of(port), bit});
    }
    if ((changed & port.watched_in) != 0) {
        schedule_lines(cycle);
    }
}

void Gpio::set_pull_ups(bool on, uint64_t cycle) {
    if (on == pull_ups_on_) {
        return;
    }
    pull_ups_on_ = on;
    for (Port& port : ports_) {
        update_pull_ups(port, cycle);
        update(port, cycle);
    }
}

bool Gpio::level(PinId pin, uint64_t cycle) {
    Port& port = ports_[pin.port];
    update(port, cycle);
    return (all_levels(port, cycle) & pin.mask()) != 0;
}

bool Gpio::input_at(PinId pin, uint64_t cycle) const {
    const Port& port = ports_[pin.port];
    if (port.lines[pin.bit] != nullptr) {
        return port.lines[pin.bit]->level_at(cycle);
    }
    if ((port.driven & pin.mask()) != 0) {
        return (port.held & pin.mask()) != 0;
    }
    return (port.pulled & pin.mask()) != 0 || noise_.level(pin, cycle);
}

bool Gpio::is_output(PinId pin) const {
    return (byte(static_cast<uint16_t>(ports_[pin.port].base + 1)) >> pin.bit & 1) != 0;
}

bool Gpio::port_bit(PinId pin) const {
    return (byte(static_cast<uint16_t>(ports_[pin.port].base + 2)) >> pin.bit & 1) != 0;
}

void Gpio::reset(uint64_t cycle) {
    pull_ups_on_ = true;
    for (Port& port : ports_) {
        port.taken = port.silent = port.interrupting = port.watched_in = port.watched = port.heard = 0;
        port.inputs_off = 0;
        port.watchers.fill(nullptr);
        port.sources.fill(nullptr);
        port.modulators.fill(nullptr);
        update_pull_ups(port, cycle);
        update(port, cycle);
    }
    note_watched_ports();
    core_.schedule.cancel(Slot::Lines);
}

void Gpio::state(Archive& archive) {
    archive(noise_, pull_ups_on_, shown_changes_);
    for (Port& port : ports_) {
        uint8_t lines = port.has_lines; // it has those that are there, also where the rest is refused
        archive(port.written, port.ddr_before, port.latch_before, port.levels, port.driven, port.held,
                port.taken, port.silent, port.interrupting, port.watched, port.heard, port.watched_in, lines,
                port.inputs_off, port.fell);
        archive.require((port.watched_in & ~lines) == 0, "a pin is watched that has no wire");
        for (unsigned bit = 0; bit < 8; bit++) {
            if ((lines >> bit & 1) != 0) {
                if (port.lines[bit] == nullptr) {
                    const PinId pin{index_of(port), static_cast<uint8_t>(bit)};
                    port.lines[bit] = std::make_unique<Line>(noise_, pin, Drive::Open);
                    port.has_lines |= pin.mask();
                }
                archive(*port.lines[bit]);
            }
        }
        port.has_lines = lines;
        if (archive.loading()) { // they enter themselves again
            port.sources.fill(nullptr);
            port.modulators.fill(nullptr);
            port.watchers.fill(nullptr);
            port.pulled = pull_ups(ddr(port), latch(port));
            port.audible = audible_pins(port);
            port.open = open_pins(port, port.watched_out, core_.cpu.cycle);
        }
    }
    note_watched_ports();
}

} // namespace tilenca::avr
