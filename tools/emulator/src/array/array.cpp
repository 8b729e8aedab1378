#include "array/array.h"

#include <algorithm>
#include <cstdio>

namespace tilenca {

Array::Array(const Image& image, const avr::Fuses& fuses, const std::vector<Clock>& clocks) : image_(image) {
    const auto program = std::make_shared<avr::Program>();
    for (const Block& block : image.flash) {
        program->write(block.address, block.bytes.data(), static_cast<uint32_t>(block.bytes.size()));
    }
    for (const Clock& clock : clocks) {
        tiles_.push_back(std::make_unique<Tile>(program, fuses, clock));
        for (const Block& block : image.eeprom) {
            std::copy(block.bytes.begin(), block.bytes.end(),
                      tiles_.back()->chip().eeprom().memory().begin() + block.address);
        }
    }
}

void Array::Wire::edge(avr::PinId, uint64_t cycle, bool level) {
    const double arrives = from_.to_ticks(cycle) + kLinkLatencyTicks;
    to_.chip().push_edge(to_pin_, to_.clock().to_cycle(arrives), level);
}

void Array::connect(Tile& from, unsigned from_side, Tile& to, unsigned to_side) {
    const avr::PinId pin = Tile::receive_pin(to_side);
    to.chip().gpio().attach_line(pin);
    wires_.push_back(std::make_unique<Wire>(from.clock(), to, pin));
    from.chip().gpio().listen(Tile::transmit_pin(from_side), wires_.back().get());
}

void Array::link(const Wiring& wiring) {
    Tile &one = tile(wiring.tile), &other = tile(wiring.other_tile);
    connect(one, wiring.side, other, wiring.other_side);
    connect(other, wiring.other_side, one, wiring.side);
}

// The time until which every tile sleeps; the present if one does not.
double Array::idle_until() {
    double soonest = HUGE_VAL;
    for (auto& tile : tiles_) {
        soonest = std::min(soonest, std::max(now_, tile->wakes_at()));
        if (soonest <= now_) {
            break;
        }
    }
    return soonest;
}

void Array::run_for(double ticks) {
    asked_for_ += ticks;
    const double end = std::ceil(asked_for_ / kQuantumTicks) * kQuantumTicks;
    while (now_ < end) {
        const double busy_from = std::floor(idle_until() / kQuantumTicks) * kQuantumTicks;
        now_ = std::min(end, busy_from + kQuantumTicks);
        for (auto& tile : tiles_) {
            tile->run_until(now_);
        }
    }
}

std::string Array::fault(unsigned index) {
    const avr::Cpu& cpu = tile(index).chip().cpu();
    if (cpu.fault.empty()) {
        return "";
    }
    const uint32_t address = 2 * cpu.pc();
    const std::string function = image_.function_at(address);
    char text[64];
    std::snprintf(text, sizeof text, "tile %u stopped at 0x%05X", index + 1, address);
    return text + (function.empty() ? "" : " in " + function) + ": " + cpu.fault;
}

} // namespace tilenca
