// The interrupts that pins raise: INT0..7, and the three banks of pin changes.
#include "avr/gpio.h"
#include "avr/pin_registers.h"
#include "avr/vectors.h"

#include <algorithm>

namespace tilenca::avr {

namespace {

constexpr uint8_t kPortB = port_index('B'), kPortD = port_index('D'), kPortE = port_index('E');
constexpr uint8_t kPortJ = port_index('J'), kPortK = port_index('K');

} // namespace

std::vector<uint8_t> Gpio::vectors() const {
    std::vector<uint8_t> all;
    for (uint8_t vector = kVectorInt0; vector < kVectorPinChange0 + 3; vector++) {
        all.push_back(vector);
    }
    return all;
}

void Gpio::interrupt_taken(uint8_t vector) {
    if (vector < kVectorPinChange0) {
        byte(kEifr) &= static_cast<uint8_t>(~(1 << (vector - kVectorInt0)));
    } else {
        byte(kPcifr) &= static_cast<uint8_t>(~(1 << (vector - kVectorPinChange0)));
    }
    update_requests();
}

// How INT0..7 is triggered: 0 low level, 1 any edge, 2 falling, 3 rising.
uint8_t Gpio::sense(unsigned number) const {
    const uint8_t control = byte(number < 4 ? kEicra : kEicrb);
    return control >> (number % 4 * 2) & 3;
}

void Gpio::external_interrupts(unsigned first, uint8_t before, uint8_t after, unsigned shift,
                               uint64_t cycle) {
    for (unsigned i = 0; i < 4; i++) {
        const bool was = (before >> (i + shift) & 1) != 0, is = (after >> (i + shift) & 1) != 0;
        const uint8_t how = sense(first + i);
        // In deep sleep, the edges of INT4..7 go unnoticed: they are found with the clock that stands.
        const bool noticed = first == 0 || !core_.cpu.deeply;
        if (was != is && noticed && (how == 1 || (how == 2 && !is) || (how == 3 && is))) {
            const bool fresh = (byte(kEifr) >> (first + i) & 1) == 0;
            byte(kEifr) |= static_cast<uint8_t>(1 << (first + i));
            if (first + i == 0 && fresh) {
                int0_(cycle);
            }
        }
    }
}

void Gpio::pin_change(unsigned bank, uint8_t changed) {
    if ((changed & byte(static_cast<uint16_t>(kPcmsk0 + bank))) != 0) {
        byte(kPcifr) |= static_cast<uint8_t>(1 << bank);
    }
}

void Gpio::pins_changed(const Port& port, uint8_t before, uint8_t after, uint64_t cycle) {
    const auto changed = static_cast<uint8_t>(before ^ after);
    const auto index = static_cast<uint8_t>(&port - ports_.data());
    for (uint8_t bit = 0; (changed & port.watched) >> bit != 0; bit++) {
        if (((changed & port.watched) >> bit & 1) != 0 && port.watchers[bit] != nullptr) {
            port.watchers[bit]->pin_changed({index, bit}, cycle, (after >> bit & 1) != 0);
        }
    }
    if (index == kPortB) {
        pin_change(0, changed);
    } else if (index == kPortE) {
        pin_change(1, changed & 1);
        external_interrupts(4, before, after, 4, cycle);
    } else if (index == kPortJ) {
        pin_change(1, static_cast<uint8_t>(changed << 1));
    } else if (index == kPortK) {
        pin_change(2, changed);
    } else if (index == kPortD) {
        external_interrupts(0, before, after, 0, cycle);
    } else {
        return;
    }
    update_requests();
}

void Gpio::update_requests() {
    const uint8_t flags = byte(kEifr), enabled = byte(kEimsk);
    uint8_t external = flags & enabled;
    for (unsigned waiting = enabled & ~flags & 0xFFu; waiting != 0; waiting &= waiting - 1) {
        const auto i = static_cast<unsigned>(__builtin_ctz(waiting));
        const Port& port = ports_[i < 4 ? kPortD : kPortE]; // INT0..3 on PD0..3, INT4..7 on PE4..7
        const bool low = sense(i) == 0 && (port.levels >> i & 1) == 0;
        external |= static_cast<uint8_t>(low << i);
    }
    const uint64_t changes = byte(kPcifr) & byte(kPcicr) & 7u;
    core_.cpu.request_all(uint64_t{0x7FF} << kVectorInt0, (changes << 8 | external) << kVectorInt0);
}

// INTn sets its flag on the edge it is told to, enabled or not; a low level raises no flag, and matters only
// while enabled.
uint8_t Gpio::external_watched() const {
    uint8_t watched = byte(kEimsk);
    for (unsigned i = 0; i < 8; i++) {
        watched |= static_cast<uint8_t>((sense(i) != 0) << i);
    }
    return watched;
}

// Edges on an input become events only while an interrupt could come of them, or its flag be seen.
void Gpio::update_watched(uint64_t cycle) {
    const uint8_t external = external_watched();
    std::array<uint8_t, kPorts> before;
    for (unsigned i = 0; i < kPorts; i++) {
        before[i] = ports_[i].watched_in;
    }
    ports_[kPortB].interrupting = byte(kPcmsk0);
    ports_[kPortJ].interrupting = byte(kPcmsk0 + 1) >> 1 & 0x7F;
    ports_[kPortE].interrupting = (byte(kPcmsk0 + 1) & 1) | (external & 0xF0);
    ports_[kPortK].interrupting = byte(kPcmsk0 + 2);
    ports_[kPortD].interrupting = external & 0x0F;
    for (unsigned i = 0; i < kPorts; i++) {
        Port& port = ports_[i];
        port.watched_in = (port.interrupting | port.watched | port.watched_out) & port.has_lines;
        const uint8_t audible = audible_pins(port);
        // What happened while nobody watched raises nothing now.
        if (const unsigned fresh = (port.watched_in & ~before[i]) | (audible & ~port.audible); fresh != 0) {
            port.levels =
                static_cast<uint8_t>((port.levels & ~fresh) | (compute_levels(port, cycle, 0xFF) & fresh));
        }
        port.audible = audible;
        if ((port.watched_in | port.audible) != 0) {
            update(port, cycle);
        }
    }
    note_watched_ports();
    schedule_lines(cycle);
    tell_sources();
}

void Gpio::note_watched_ports() {
    watched_ports_ = 0;
    for (unsigned i = 0; i < kPorts; i++) {
        watched_ports_ |= static_cast<uint16_t>(((ports_[i].watched_in | ports_[i].audible) != 0) << i);
    }
}

void Gpio::schedule_lines(uint64_t cycle) {
    uint64_t soonest = kNever;
    for (unsigned ports = watched_ports_; ports != 0; ports &= ports - 1) {
        const auto index = static_cast<unsigned>(__builtin_ctz(ports));
        const Port& port = ports_[index];
        for (unsigned pins = port.watched_in; pins != 0; pins &= pins - 1) {
            const auto edge = port.lines[static_cast<unsigned>(__builtin_ctz(pins))]->next_after(cycle);
            soonest = edge ? std::min(soonest, edge->cycle) : soonest;
        }
        if (port.audible != 0) {
            soonest = std::min(soonest, noise_.next_change(index, port.audible, cycle));
        }
    }
    core_.schedule.set(Slot::Lines, soonest);
}

void Gpio::on_event(Slot, uint64_t cycle) {
    for (unsigned ports = watched_ports_; ports != 0; ports &= ports - 1) {
        update(ports_[static_cast<unsigned>(__builtin_ctz(ports))], cycle);
    }
    schedule_lines(cycle);
}

} // namespace tilenca::avr
