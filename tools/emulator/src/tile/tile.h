// The tile: an ATmega2560 on its board, as far as eyes, fingers and cables can reach it.
#pragma once

#include "avr/chip.h"
#include "tile/clock.h"
#include "tile/host_port.h"
#include "tile/probe.h"

#include <memory>
#include <vector>

namespace tilenca {

constexpr unsigned kSides = 4; // N E S W; the opposite of a side is two further

// Where the data of a program end, by its symbols: the stack shall not reach further down.
struct DataEnd {
    uint16_t fixed = avr::kSramStart;
    uint16_t heap_pointer = 0; // address of malloc's variable that says where the heap ends; 0: no heap
};

class Tile {
  public:
    struct DisplayChange {
        double ticks;
        uint8_t segments;
        void state(avr::Archive& archive) { archive(ticks, segments); }
    };

    Tile(std::shared_ptr<avr::Program> program, const avr::Fuses& fuses, const Clock& clock,
         const DataEnd& data_end);

    // Runs until a time in ticks, of a turn that ends then or later; a fault stops the tile for good. The
    // computer's end and the display are looked at when turns end.
    void run_until(double end, double turn_end);
    // When the tile next does anything, in ticks.
    double wakes_at();
    // Before it runs.
    void set_hardware(const avr::Hardware& hardware);
    // Whether it is switched on, and has been plugged in by then, in ticks.
    bool is_on(double now) const { return powered_ && clock_.to_ticks(0) <= now; }
    // Off, it does nothing and drives nothing; on again, it starts as new, but for its flash and EEPROM.
    void set_power(bool on);
    bool is_powered() const { return powered_; }
    uint64_t cycles_off() const { return cycles_off_; }

    avr::Chip& chip() { return chip_; }
    Clock& clock() { return clock_; }
    HostPort& host() { return host_; }

    uint8_t segments();           // bit 0 = a ... bit 6 = g, bit 7 = dp
    uint8_t leds();               // bit 0..3: debug LED of N E S W
    void colour(uint8_t duty[3]); // R G B, 0..255
    void press_button(bool pressed);
    const std::vector<DisplayChange>& display_changes() const { return display_changes_; }

    // Looks at a pin from now on; the probe lives as long as the tile.
    Probe& add_probe(avr::PinId pin);
    void remove_probe(Probe& probe);
    // How long a bit takes, in ticks, on a pin that belongs to a USART that is on; 0 otherwise.
    double bit_ticks(avr::PinId pin);

    // Which of a wire's two lists it writes in its turn; it reads the other one.
    unsigned list() const { return list_; }
    void use_list(unsigned list) { list_ = list; }

    static avr::PinId receive_pin(unsigned side);
    static avr::PinId transmit_pin(unsigned side);
    void state(avr::Archive& archive);

  private:
    double bit_ticks(unsigned usart);
    void execute_until(double end, uint64_t cycle);
    uint16_t stack_floor() const;
    void clear_heap_pointer();
    bool lit(avr::PinId pin);
    void note_display(double turn_end);

    Clock clock_;
    avr::Chip chip_;
    HostPort host_;
    DataEnd data_end_;
    unsigned list_ = 0;
    bool powered_ = true;
    uint64_t cycles_off_ = 0;
    uint64_t seen_changes_ = ~uint64_t{0};
    uint8_t shown_ = 0;
    std::vector<DisplayChange> display_changes_;
    std::vector<std::unique_ptr<Probe>> probes_;
};

} // namespace tilenca
