#include "tile/tile.h"

#include "board/pins.h"

#include <cmath>

namespace tilenca {

namespace {

constexpr avr::PinId on_chip(board::Pin pin) {
    return {avr::port_index(pin.port), pin.bit};
}

constexpr unsigned kSouth = 2;

// A USART's pins are facts of the chip, so any instance of it may be asked: RX, then TX.
constexpr avr::PinId kUsartPins[4][2] = {
    {{avr::port_index('E'), 0}, {avr::port_index('E'), 1}},
    {{avr::port_index('D'), 2}, {avr::port_index('D'), 3}},
    {{avr::port_index('H'), 0}, {avr::port_index('H'), 1}},
    {{avr::port_index('J'), 0}, {avr::port_index('J'), 1}},
};

} // namespace

avr::PinId Tile::receive_pin(unsigned side) {
    return side == kSouth ? on_chip(board::kSouthRx) : kUsartPins[board::kSideUsart[side]][0];
}

avr::PinId Tile::transmit_pin(unsigned side) {
    return side == kSouth ? on_chip(board::kSouthTx) : kUsartPins[board::kSideUsart[side]][1];
}

Tile::Tile(std::shared_ptr<avr::Program> program, const avr::Fuses& fuses, const Clock& clock)
    : clock_(clock), chip_(std::move(program), fuses), host_(clock_, [this](double ticks, bool level) {
          chip_.push_edge(kUsartPins[board::kHostUsart][0], clock_.to_cycle(ticks), level);
      }) {
    chip_.gpio().attach_line(kUsartPins[board::kHostUsart][0]);
    chip_.gpio().listen(kUsartPins[board::kHostUsart][1], &host_);
}

void Tile::run_until(double end) {
    if (const uint64_t cycle = clock_.to_cycle(end); cycle != 0) {
        chip_.run_until(cycle);
        note_display();
        host_.follow(chip_.usart(board::kHostUsart).bit_cycles());
    }
    host_.run_until(end);
}

double Tile::wakes_at() {
    if (!host_.all_sent()) {
        return 0;
    }
    if (!chip_.cpu().fault.empty()) {
        return HUGE_VAL;
    }
    const uint64_t cycle = chip_.wakes_at();
    return cycle == avr::kNever ? HUGE_VAL : clock_.to_ticks(cycle);
}

void Tile::note_display() {
    if (chip_.gpio().output_changes() == seen_changes_) {
        return;
    }
    seen_changes_ = chip_.gpio().output_changes();
    if (const uint8_t now = segments(); now != shown_) {
        shown_ = now;
        display_changes_.push_back({clock_.to_ticks(chip_.cpu().cycle), now});
    }
}

bool Tile::lit(avr::PinId pin) {
    return chip_.gpio().is_output(pin) && chip_.gpio().level(pin, chip_.cpu().cycle);
}

uint8_t Tile::segments() {
    unsigned mask = 0;
    for (unsigned i = 0; i < 8; i++) {
        mask |= static_cast<unsigned>(lit(on_chip(board::kSegments[i]))) << i;
    }
    return static_cast<uint8_t>(mask);
}

uint8_t Tile::leds() {
    unsigned mask = 0;
    for (unsigned i = 0; i < kSides; i++) {
        mask |= static_cast<unsigned>(lit(on_chip(board::kDebugLeds[i]))) << i;
    }
    return static_cast<uint8_t>(mask);
}

void Tile::colour(uint8_t duty[3]) {
    const board::Pin pins[3] = {board::kRed, board::kGreen, board::kBlue};
    for (unsigned i = 0; i < 3; i++) {
        duty[i] = static_cast<uint8_t>(std::lround(chip_.duty(on_chip(pins[i])) * 255));
    }
}

void Tile::press_button(bool pressed) {
    chip_.gpio().hold_input(on_chip(board::kButton), !pressed, chip_.cpu().cycle);
}

} // namespace tilenca
