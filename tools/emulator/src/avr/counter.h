// A timer's counter and compare units, in ticks of its own clock: the arithmetic of the waveform modes.
//
// Knows no registers and no time. Flags are set by the tick on which the counter leaves the value in
// question.
#pragma once

#include "avr/archive.h"

#include <array>
#include <cstdint>

namespace tilenca::avr {

constexpr uint8_t kFlagOverflow = 1, kFlagCompareA = 2, kFlagCapture = 0x20;

enum class Wave : uint8_t { Normal, Ctc, Fast, PhaseCorrect, PhaseAndFrequencyCorrect };
enum class Top : uint8_t { Fixed, CompareA, Capture };
constexpr Wave last_of(Wave) {
    return Wave::PhaseAndFrequencyCorrect;
}
constexpr Top last_of(Top) {
    return Top::Capture;
}

struct WaveMode {
    Wave wave = Wave::Normal;
    Top top = Top::Fixed;
    uint16_t fixed_top = 0xFF;
};

class Counter {
  public:
    Counter(uint16_t max, unsigned channels) : max_(max), channels_(channels) {}

    void reset();
    void set_mode(const WaveMode& mode);
    void set_output(unsigned channel, uint8_t action) { actions_[channel] = action; }
    void set_count(uint16_t count);
    void set_compare(unsigned channel, uint16_t value);
    void set_capture(uint16_t value) {
        capture_ = value;
        free_ticks_ = 0;
    }
    void force_compare(unsigned channel) { act(channel); }
    // An edge of the capture unit's input.
    void capture_now();

    void advance(uint64_t ticks) {
        if (ticks < free_ticks_) {
            count_ = static_cast<uint16_t>(down_ ? count_ - ticks : count_ + ticks);
            free_ticks_ -= static_cast<uint32_t>(ticks);
            blocked_ = blocked_ && ticks == 0;
        } else {
            advance_far(ticks);
        }
    }
    // Ticks until one of the flags in `mask` is set, or a buffered compare value takes effect; 0: never.
    uint64_t ticks_to_flag(uint8_t mask) const;
    // Ticks until an output may change.
    uint64_t ticks_to_change() const { return ticks_to_boundary(); }
    void state(Archive& archive);

    uint16_t count() const { return count_; }
    uint16_t compare(unsigned channel) const { return buffers_[channel]; }
    uint16_t capture() const { return capture_; }
    // The bits that a compare register has: as many as the mode counts.
    uint16_t compare_mask() const { return mode_.top == Top::Fixed ? mode_.fixed_top : 0xFFFF; }
    uint16_t top() const;
    const WaveMode& mode() const { return mode_; }
    // The output's level now, and its share of time high (0..1).
    bool level(unsigned channel) const;
    double duty(unsigned channel) const;

    uint8_t flags = 0;

  private:
    bool is_pwm() const { return mode_.wave >= Wave::Fast; }
    bool is_two_way() const { return mode_.wave >= Wave::PhaseCorrect; }
    bool toggles(unsigned channel) const { return actions_[channel] == 1; }
    uint64_t period() const;
    bool is_settled() const;
    bool only_sets_flags() const;
    void advance_plainly(uint64_t ticks);
    void advance_far(uint64_t ticks);
    uint64_t step(uint64_t ticks);
    uint64_t ticks_to_boundary() const;
    uint64_t ticks_to_leave(uint16_t value, bool either_way) const;
    uint64_t ticks_to_reload() const;
    void leave();
    void turn_or_wrap(uint16_t top);
    void act(unsigned channel);
    void load_buffers() { compares_ = buffers_; }

    uint16_t max_;
    unsigned channels_;
    uint32_t free_ticks_ = 0; // until the count reaches a value at which anything happens; 0: not known
    WaveMode mode_;
    uint16_t count_ = 0;
    uint16_t capture_ = 0;
    bool down_ = false;
    bool blocked_ = false; // a write to the count hides the match of the next tick
    std::array<uint16_t, 3> compares_{};
    std::array<uint16_t, 3> buffers_{};
    std::array<uint8_t, 3> actions_{}; // COMnx: 0 none, 1 toggle, 2 clear, 3 set
    std::array<bool, 3> levels_{};
};

} // namespace tilenca::avr
