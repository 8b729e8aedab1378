// The eleven ports, their pins' levels, and the interrupts that pins raise.
//
// An input is driven from outside, or its pull-up lifts it, or it floats: then it reads noise. Noise is
// looked up where a program reads it, and becomes events only where an edge could do something.
#pragma once

#include "avr/line.h"
#include "avr/peripheral.h"

#include <array>
#include <functional>
#include <memory>

namespace tilenca::avr {

// Told of every change on the outputs it asked for. Changes can be announced ahead of time, and taken back by
// a later call with an earlier cycle: from that cycle on, only the later call counts.
// `open`: the pin is an input that neither its pull-up nor anybody outside drives; its noise is not told.
struct EdgeListener {
    virtual ~EdgeListener() = default;
    virtual void edge(PinId pin, uint64_t cycle, bool level, bool open) = 0;
};

// A part that overrides a port's pin: a timer's compare output.
struct PinSource {
    virtual ~PinSource() = default;
    virtual bool pin_level(PinId pin, uint64_t cycle) = 0;
    // Somebody began or ceased to ask for the moments at which the pin changes.
    virtual void observers_changed() = 0;
};

// Told of every change of a pin, whoever drives it, when it happens.
struct PinWatcher {
    virtual ~PinWatcher() = default;
    virtual void pin_changed(PinId pin, uint64_t cycle, bool level) = 0;
};

class Gpio final : public Peripheral {
  public:
    explicit Gpio(const Core& core);

    std::vector<uint16_t> registers() const override;
    uint8_t read(uint16_t address, uint64_t cycle) override;
    bool reads_as_stored(uint16_t address) const override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void on_event(Slot slot, uint64_t cycle) override;
    std::vector<uint8_t> vectors() const override;
    void interrupt_taken(uint8_t vector) override;
    void reset(uint64_t cycle) override;

    // What inputs read that nobody drives; before anything runs.
    Noise& noise() { return noise_; }
    // MCUCR's PUD turns all pull-ups off.
    void set_pull_ups(bool on, uint64_t cycle);
    // Pins whose digital input is off read as zero (DIDRn).
    void set_inputs_off(uint8_t port, uint8_t mask) { ports_[port].inputs_off = mask; }

    // Connects an input to a wire whose edges are known ahead of time, and that somebody drives so.
    Line& attach_line(PinId pin, Drive drive);
    bool has_line(PinId pin) const { return (ports_[pin.port].has_lines & pin.mask()) != 0; }
    // Of a pin that had one before a snapshot was loaded, which has none there, it is still here.
    Line* line(PinId pin) { return ports_[pin.port].lines[pin.bit].get(); }
    // To be called after edges were pushed on a line.
    void line_changed(PinId pin);
    // Holds an input at a level from outside: a button, a resistor. Nothing: lets it go.
    void hold_input(PinId pin, std::optional<bool> level, uint64_t cycle);
    // Told when a line is driven in another way than was known: held, let go, or its pull-up switched.
    void on_line_changed(std::function<void(PinId)> call) { line_was_changed_ = std::move(call); }

    void listen(PinId pin, EdgeListener* listener);
    void ignore(PinId pin, EdgeListener* listener);
    // A peripheral that takes its input from a pin; at most one for each. Null: none any more. With `noise`,
    // of a pin that floats, too.
    void watch(PinId pin, PinWatcher* watcher, bool noise, uint64_t cycle);
    // A watcher enters itself again after its state has been loaded.
    void watch_again(PinId pin, PinWatcher* watcher) { ports_[pin.port].watchers[pin.bit] = watcher; }
    // Whether a change of the pin must be known when it happens.
    bool is_observed(PinId pin) const;
    // A pin that a timer drives has changed.
    void source_changed(PinId pin, uint64_t cycle) { update(ports_[pin.port], cycle); }
    // An edge of INT0 starts a conversion.
    void on_int0(std::function<void(uint64_t)> call) { int0_ = std::move(call); }
    void state(Archive& archive) override;
    // Announces a level on an output that a USART has taken over, now or later.
    void announce(PinId pin, uint64_t cycle, bool level) { tell(pin, cycle, level, false); }
    // A USART lets its output go: what was announced for later does not happen.
    void announce_port(PinId pin, uint64_t cycle);
    // A USART or timer takes a pin from its port, or gives it back (null). A USART's transmitter needs no
    // source: nobody reads its pin back.
    void take_over(PinId pin, PinSource* source, bool as_output, uint64_t cycle);
    // source: who gives it back, where two may have it.
    void release(PinId pin, uint64_t cycle, const PinSource* source = nullptr);
    // A source enters itself again after its state has been loaded.
    void drive_again(PinId pin, PinSource* source);

    bool level(PinId pin, uint64_t cycle);
    // As of when somebody looked last; a pin that floats is lifted by who looks.
    bool last_level(PinId pin) const {
        const Port& port = ports_[pin.port];
        return ((port.levels | port.open) >> pin.bit & 1) != 0;
    }
    bool is_output(PinId pin) const;
    // What comes from outside, at a time that may lie a little back.
    bool input_at(PinId pin, uint64_t cycle) const;
    // What the pin does to its wire.
    Drive drive(PinId pin, uint64_t cycle);
    bool port_bit(PinId pin) const;
    // From now on it is known when this output was high last.
    void remember(PinId pin) { ports_[pin.port].remembered |= pin.mask(); }
    // Whether it is high, or was so within so many cycles.
    bool was_high(PinId pin, uint64_t cycle, uint64_t within) {
        const bool is_high = level(pin, cycle); // which brings the other up to date
        const uint64_t fell = ports_[pin.port].fell[pin.bit];
        return is_high || (fell != kNever && cycle - fell < within);
    }
    // From now on changes of this pin count: of its direction, its port bit, or what a timer makes of it.
    void show(PinId pin) { ports_[pin.port].shown |= pin.mask(); }
    // Cheap to compare, to know whether to look at the shown pins again.
    uint64_t shown_changes() const { return shown_changes_; }
    // A timer may have changed the share of time that a pin is high.
    void note_shown(PinId pin) { shown_changes_ += (ports_[pin.port].shown & pin.mask()) != 0; }
    // Whether a timer or a USART drives a pin in its port's place.
    bool is_taken(PinId pin) const { return (ports_[pin.port].taken & pin.mask()) != 0; }

  private:
    struct Port {
        uint16_t base = 0;    // PIN; DDR and PORT follow
        uint8_t exist = 0xFF; // its pins
        uint64_t written = 0; // cycle of the last write to any of the three
        uint8_t ddr_before = 0, latch_before = 0;
        uint8_t levels = 0xFF;    // of floating pins, only where they are audible
        uint8_t driven = 0;       // pins held from outside, without a line
        uint8_t held = 0;         // their levels
        uint8_t pulled = 0;       // inputs whose pull-up is on
        uint8_t open = 0;         // pins with a listener that nothing drives
        uint8_t audible = 0;      // floating pins of which the next edge must be known
        uint8_t inputs_off = 0;   // they read as zero
        uint8_t taken = 0;        // outputs that a peripheral drives
        uint8_t silent = 0;       // of them: a USART's, which announces its edges by itself
        uint8_t watched_out = 0;  // outputs with a listener
        uint8_t interrupting = 0; // pins whose edges raise interrupts
        uint8_t watched = 0;      // pins that a peripheral takes its input from
        uint8_t heard = 0;        // of them: their noise, too
        uint8_t watched_in = 0;   // inputs on a line of which the next edge must be known
        uint8_t has_lines = 0;
        uint8_t shown = 0;      // pins that are looked at from time to time
        uint8_t remembered = 0; // outputs of which the last time that they were high is kept
        std::array<uint64_t, 8> fell{kNever, kNever, kNever, kNever, kNever, kNever, kNever, kNever};
        std::array<PinSource*, 8> sources{};
        // The output compare modulator: a second source; PORT decides between AND (0) and OR (1).
        std::array<PinSource*, 8> modulators{};
        std::array<std::vector<EdgeListener*>, 8> listeners{};
        std::array<PinWatcher*, 8> watchers{};
        std::array<std::unique_ptr<Line>, 8> lines;
    };

    Port* port_of(uint16_t address, unsigned* which);
    static constexpr uint16_t kPortsFirst = 0x20, kPortsEnd = 0x35, kFarPortsFirst = 0x100,
                              kFarPortsEnd = 0x10C;
    uint8_t& ddr(const Port& port) const { return byte(static_cast<uint16_t>(port.base + 1)); }
    uint8_t& latch(const Port& port) const { return byte(static_cast<uint16_t>(port.base + 2)); }
    uint8_t index_of(const Port& port) const { return static_cast<uint8_t>(&port - ports_.data()); }
    uint8_t compute_levels(Port& port, uint64_t cycle, uint8_t ddr, uint8_t latch, uint8_t noise_of);
    uint8_t compute_levels(Port& port, uint64_t cycle, uint8_t noise_of) {
        return compute_levels(port, cycle, ddr(port), latch(port), noise_of);
    }
    uint8_t open_pins(const Port& port, uint8_t mask, uint64_t cycle) const;
    uint8_t pull_ups(uint8_t ddr, uint8_t latch) const {
        return pull_ups_on_ ? static_cast<uint8_t>(latch & ~ddr) : 0;
    }
    void update_pull_ups(Port& port, uint64_t cycle);
    // Inputs without a line that nothing drives.
    uint8_t floating_pins(const Port& port, uint8_t ddr, uint8_t pulled) const {
        return static_cast<uint8_t>(~(ddr | pulled | port.driven | port.has_lines) & port.exist);
    }
    uint8_t audible_pins(const Port& port) const;
    uint8_t all_levels(Port& port, uint64_t cycle);
    uint8_t pins_as_read(Port& port, uint64_t cycle);
    void update(Port& port, uint64_t cycle);
    void pins_changed(const Port& port, uint8_t before, uint8_t after, uint64_t cycle);
    void tell(PinId pin, uint64_t cycle, bool level, bool open);
    void tell_sources();
    void external_interrupts(unsigned first, uint8_t before, uint8_t after, unsigned shift, uint64_t cycle);
    void pin_change(unsigned bank, uint8_t changed);
    void update_requests();
    uint8_t external_watched() const;
    void update_watched(uint64_t cycle);
    void note_watched_ports();
    void schedule_lines(uint64_t cycle);
    uint8_t sense(unsigned number) const;

    std::array<Port, kPorts> ports_;
    Noise noise_;
    bool pull_ups_on_ = true;
    uint16_t watched_ports_ = 0; // those with a pin that is watched_in, or audible
    uint64_t shown_changes_ = 0;
    std::function<void(uint64_t)> int0_ = [](uint64_t) {};
    std::function<void(PinId)> line_was_changed_ = [](PinId) {};
};

} // namespace tilenca::avr
