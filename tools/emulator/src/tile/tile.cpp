#include "tile/tile.h"

#include "board/pins.h"

#include <algorithm>
#include <cmath>

namespace tilenca {

namespace {

constexpr avr::PinId on_chip(board::Pin pin) {
    return {avr::port_index(pin.port), pin.bit};
}

constexpr unsigned kSouth = 2;
constexpr uint64_t kEyeCycles = 320'000; // 20 ms: what is lit more often than that seems to be lit
// What a link LED and its resistor leave of a pull-up, on the ADC's channel of its pin (ADC8 is PK0): 1.8 V.
constexpr unsigned kFirstLedChannel = 8, kLedPulledUp = 370;
constexpr double kAheadTicks = 64; // of the last instruction of a turn, at most

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

Tile::Tile(std::shared_ptr<avr::Program> program, const avr::Fuses& fuses, const Clock& clock,
           const DataEnd& data_end)
    : clock_(clock), chip_(std::move(program), fuses),
      host_(clock_,
            [this](double ticks, bool level) {
                chip_.push_edge(kUsartPins[board::kHostUsart][0], clock_.to_cycle(ticks),
                                avr::drive_of(level));
            }),
      data_end_(data_end) {
    chip_.gpio().attach_line(kUsartPins[board::kHostUsart][0], avr::Drive::High); // by the bridge to USB
    press_button(false); // it has a pull-up of its own
    chip_.gpio().listen(kUsartPins[board::kHostUsart][1], &host_);
    for (const board::Pin& segment : board::kSegments) {
        chip_.gpio().show(on_chip(segment));
    }
    for (const board::Pin& led : board::kDebugLeds) {
        chip_.gpio().remember(on_chip(led));
        chip_.adc().set_input(kFirstLedChannel + led.bit, kLedPulledUp);
    }
}

void Tile::run_until(double end, double turn_end) {
    clock_.follow_drift(turn_end);
    const uint64_t cycle = clock_.to_cycle(end);
    if (cycle != 0) {
        if (powered_) {
            execute_until(end, cycle);
        } else if (cycle > chip_.cpu().cycle) {
            cycles_off_ += cycle - chip_.cpu().cycle;
            chip_.pass_while_off(cycle);
        }
    }
    const bool turn_ends = end == turn_end;
    if (turn_ends && cycle != 0) {
        note_display(turn_end);
        host_.follow(bit_ticks(board::kHostUsart));
    }
    host_.receive_until(end);
    if (turn_ends) {
        host_.send_until(end);
    }
    for (const auto& probe : probes_) {
        if (turn_ends && probe->follows()) {
            probe->receiver().follow(bit_ticks(probe->pin()));
        }
        probe->settle(end);
    }
}

uint16_t Tile::stack_floor() const {
    if (chip_.has_changed_flash()) {
        return avr::kSramStart;
    }
    if (data_end_.heap_pointer == 0) {
        return data_end_.fixed;
    }
    const uint8_t* const heap = chip_.cpu().data + data_end_.heap_pointer;
    return std::max(data_end_.fixed, static_cast<uint16_t>(heap[0] | heap[1] << 8));
}

void Tile::execute_until(double end, uint64_t cycle) {
    avr::Cpu& cpu = chip_.cpu();
    if (const uint16_t floor = stack_floor(); floor != cpu.stack_floor) {
        cpu.set_stack_floor(floor);
    }
    chip_.run_until(cycle);
    while (cpu.yields) { // its program has changed the speed of its clock
        cpu.yields = false;
        clock_.divide(cpu.clock_divisor, cpu.cycle);
        chip_.run_until(clock_.to_cycle(end));
    }
}

// Noise in it, until the program's start-up has cleared it, would look like a heap.
void Tile::clear_heap_pointer() {
    if (data_end_.heap_pointer != 0) {
        chip_.cpu().data[data_end_.heap_pointer] = chip_.cpu().data[data_end_.heap_pointer + 1] = 0;
    }
}

void Tile::set_hardware(const avr::Hardware& hardware) {
    chip_.set_hardware(hardware);
    clear_heap_pointer();
}

void Tile::set_power(bool on) {
    if (on == powered_) {
        return;
    }
    powered_ = on;
    if (on) {
        chip_.power_on();
    } else {
        chip_.power_off(); // which leaves all pins floating, too
    }
    clear_heap_pointer();
    clock_.divide(chip_.cpu().clock_divisor, chip_.cpu().cycle);
}

// As nominal as a program means it.
double Tile::bit_ticks(unsigned usart) {
    return static_cast<double>(chip_.usart(usart).bit_cycles()) * chip_.cpu().clock_divisor;
}

double Tile::bit_ticks(avr::PinId pin) {
    for (unsigned i = 0; i < 4; i++) {
        for (const avr::PinId own : kUsartPins[i]) {
            if (own.port == pin.port && own.bit == pin.bit) {
                return bit_ticks(i);
            }
        }
    }
    return 0;
}

Probe& Tile::add_probe(avr::PinId pin) {
    const bool level = chip_.gpio().drive(pin, chip_.cpu().cycle) != avr::Drive::Low;
    probes_.push_back(std::make_unique<Probe>(clock_, pin, level));
    chip_.gpio().listen(pin, probes_.back().get());
    return *probes_.back();
}

void Tile::remove_probe(Probe& probe) {
    chip_.gpio().ignore(probe.pin(), &probe);
    probes_.erase(std::find_if(probes_.begin(), probes_.end(),
                               [&probe](const auto& one) { return one.get() == &probe; }));
}

double Tile::wakes_at() {
    if (!host_.all_sent()) {
        return 0;
    }
    if (!powered_ || !chip_.cpu().fault.empty() || chip_.cpu().halted) {
        return HUGE_VAL;
    }
    const uint64_t cycle = chip_.wakes_at();
    if (cycle <= chip_.cpu().cycle) {
        return 0;
    }
    return cycle == avr::kNever ? HUGE_VAL : clock_.to_ticks(cycle);
}

void Tile::note_display(double turn_end) {
    if (chip_.gpio().shown_changes() == seen_changes_) {
        return;
    }
    seen_changes_ = chip_.gpio().shown_changes();
    if (const uint8_t now = segments(); now != shown_) {
        shown_ = now;
        // A chip that starts is ahead of time.
        display_changes_.push_back(
            {std::min(clock_.to_ticks(chip_.cpu().cycle), turn_end + kAheadTicks), now});
    }
}

// A program may dim it by lighting it now and then.
bool Tile::lit(avr::PinId pin) {
    return chip_.gpio().is_output(pin) && chip_.gpio().was_high(pin, chip_.cpu().cycle, kEyeCycles);
}

uint8_t Tile::segments() {
    unsigned mask = 0;
    for (unsigned i = 0; i < 8; i++) {
        // Dimmed by its timer it is lit all the time, as far as eyes can tell.
        mask |= static_cast<unsigned>(chip_.duty(on_chip(board::kSegments[i])) > 0) << i;
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

void Tile::state(avr::Archive& archive) {
    archive(clock_, powered_, cycles_off_, host_, seen_changes_, shown_, display_changes_, chip_);
    if (archive.loading()) {
        for (const auto& probe : probes_) {
            probe->restart(chip_.gpio().last_level(probe->pin())); // looking would change what was loaded
        }
    }
}

} // namespace tilenca
