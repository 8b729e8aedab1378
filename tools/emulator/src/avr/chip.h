// A whole ATmega2560: the core and everything around it. Knows nothing of the board it sits on.
#pragma once

#include "avr/comparator.h"
#include "avr/eeprom.h"
#include "avr/gpio.h"
#include "avr/hardware.h"
#include "avr/self_programming.h"
#include "avr/spi.h"
#include "avr/timer.h"
#include "avr/twi.h"
#include "avr/usart.h"
#include "avr/vectors.h"
#include "avr/watchdog.h"

#include <map>
#include <memory>
#include <set>

namespace tilenca::avr {

constexpr double kNominalHz = 16e6;

// Bits of MCUSR.
enum class ResetCause : uint8_t { PowerOn = 1, External = 2, BrownOut = 4, Watchdog = 8 };

// The clock passed a marked instruction.
struct MarkPassed {
    uint32_t word;
    uint64_t cycle;
};

class Chip final : private Bus {
  public:
    Chip(std::shared_ptr<Program> program, const Fuses& fuses);
    ~Chip() override;
    Chip(const Chip&) = delete;
    Chip& operator=(const Chip&) = delete;

    void reset(ResetCause cause);
    // What is not ideal about it; before it runs, and switched on with it anew.
    void set_hardware(const Hardware& hardware);
    // Its supply goes: as reset, and SRAM forgets.
    void power_off();
    void power_on();
    // As long as it is off, time passes and nothing happens.
    void pass_while_off(uint64_t cycle);
    // Runs until `cycle` is reached or passed, or a fault stops the core.
    void run_until(uint64_t cycle) { cpu_.run(cycle); }
    void step() { cpu_.step(); }

    Cpu& cpu() { return cpu_; }
    const Cpu& cpu() const { return cpu_; }
    Gpio& gpio() { return *gpio_; }
    Eeprom& eeprom() { return *eeprom_; }
    Adc& adc() { return *adc_; }
    Comparator& comparator() { return *comparator_; }
    Spi& spi() { return *spi_; }
    Fuses& fuses() { return fuses_; }
    Usart& usart(unsigned number) { return *usarts_[number]; }
    const uint8_t* flash() const { return program_->bytes(); }
    // Whether it has programmed itself: then the image's symbols tell nothing any more.
    bool has_changed_flash() const { return self_programming_->has_changed_flash(); }
    const Warnings& warnings() const { return warnings_; }
    // From `cycle` on an input is driven so; the pin has a line attached.
    void push_edge(PinId pin, uint64_t cycle, Drive drive);
    // Share of time (0..1) an output is high now.
    double duty(PinId pin);
    // When the core next does anything at all: kNever if it sleeps for good.
    uint64_t wakes_at();

    // The core halts before the instruction at a word of flash.
    void set_breakpoint(uint32_t word, bool set);
    // Notes the cycle at which the instruction at a word of flash begins.
    void set_mark(uint32_t word, bool set);
    std::vector<MarkPassed>& marks_passed() { return marks_passed_; }
    // Whether running it can end at a breakpoint, or after one step.
    bool may_halt() const { return !breakpoints_.empty() || cpu_.halts_after_one; }
    // Whether the next instruction is under a trap.
    bool is_trapped() const { return program_->traps().count(cpu_.pc()) != 0; }
    // Executes the instruction before which the core has halted.
    void step_halted();

    // All that is not the same for every chip with this image; traps stay as they are.
    void state(Archive& archive);

  private:
    uint8_t read(uint16_t address, uint64_t cycle) override;
    void write(uint16_t address, uint8_t value, uint64_t cycle) override;
    void write_bit(uint16_t address, uint8_t mask, bool value, uint64_t cycle) override;
    uint64_t serve_events(uint64_t cycle) override;
    void interrupt_taken(uint8_t vector, uint64_t cycle) override;
    void watchdog_reset(uint64_t cycle) override { watchdog_->restart(cycle); }
    uint32_t store_program_memory(uint32_t word, uint64_t cycle, bool advance_z) override;
    uint8_t read_program_memory(uint32_t word, uint32_t address) override;
    void address_outside_memory(uint16_t address, bool write) override;
    void sleep_changed(bool asleep, uint64_t cycle) override;
    bool trapped(uint32_t word, uint64_t cycle) override;
    void lift_trap(uint32_t word, bool lifted) override;

    void attach(Peripheral& peripheral);
    void join();
    void update_triggers(uint64_t cycle);
    void update_clocks(uint64_t cycle);
    void forget_sram();
    void restart(ResetCause cause);
    uint64_t start_up_cycles(ResetCause cause) const;
    void write_stack_pointer(uint16_t address, uint8_t value, uint64_t cycle);
    void write_clock_prescaler(uint8_t value, uint64_t cycle);
    void update_trap(uint32_t word);
    void flash_state(Archive& archive);
    void forget_past(PinId pin);
    void line_changed(PinId pin);
    void write_system(uint16_t address, uint8_t value, uint64_t cycle);
    void write_control(uint8_t value, uint64_t cycle);
    void synchronise_prescalers(uint8_t value, uint64_t cycle);
    Peripheral& find_at_slot(Slot slot);

    const std::shared_ptr<Program> image_; // as loaded
    std::shared_ptr<Program> program_;
    Fuses fuses_;
    Cpu cpu_;
    Schedule schedule_;
    Warnings warnings_;
    std::unique_ptr<Gpio> gpio_;
    std::unique_ptr<Eeprom> eeprom_;
    std::unique_ptr<Adc> adc_;
    std::unique_ptr<Comparator> comparator_;
    std::unique_ptr<Spi> spi_;
    std::unique_ptr<Twi> twi_;
    std::unique_ptr<Watchdog> watchdog_;
    std::unique_ptr<SelfProgramming> self_programming_;
    Prescaler prescaler_, own_prescaler_; // of timer 2
    std::array<std::unique_ptr<Timer>, 6> timers_;
    std::array<std::unique_ptr<Usart>, 4> usarts_;
    std::array<Peripheral*, kSramStart> at_address_{};
    std::array<Peripheral*, kVectors> at_vector_{};
    std::array<Peripheral*, kSlots> at_slot_{};
    std::vector<Peripheral*> all_;
    uint64_t vectors_movable_until_ = 0, prescaler_changeable_until_ = 0, jtag_changeable_until_ = 0;
    uint8_t jtag_wanted_ = 0;
    uint16_t stack_before_ = 0; // the stack pointer while its two bytes are being written
    uint64_t stack_written_until_ = 0;
    std::set<uint32_t> breakpoints_, marks_;
    std::vector<MarkPassed> marks_passed_;
    Hardware hardware_;
    Random random_; // of the contents of SRAM
    bool told_read_ = false, told_write_ = false;
};

} // namespace tilenca::avr
