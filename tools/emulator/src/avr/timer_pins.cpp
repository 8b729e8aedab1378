// A timer's pins: compare outputs, the capture unit's input, the external clock.
#include "avr/timer.h"

namespace tilenca::avr {

namespace {

constexpr uint8_t kCaptureRising = 0x40, kCaptureFiltered = 0x80; // in TCCRnB
constexpr uint64_t kFilterCycles = 4;

struct Inputs {
    PinId clock, capture;
};

// Timers 0 and 2 capture nothing, and timer 2 has no T pin.
constexpr Inputs kInputs[6] = {
    {{port_index('D'), 7}, {}},
    {{port_index('D'), 6}, {port_index('D'), 4}},
    {},
    {{port_index('E'), 6}, {port_index('E'), 7}},
    {{port_index('H'), 7}, {port_index('L'), 0}},
    {{port_index('L'), 2}, {port_index('L'), 1}},
};

} // namespace

// A channel whose COM bits ask for it takes its pin; "toggle" needs a mode whose top is a register.
void Timer::apply_outputs(uint64_t cycle) {
    const WaveMode& mode = counter_.mode();
    for (unsigned i = 0; i < channels(); i++) {
        uint8_t action = byte(control_a()) >> (6 - 2 * i) & 3;
        const bool can_toggle = mode.wave < Wave::Fast || (i == 0 && mode.top != Top::Fixed);
        action = action == 1 && !can_toggle ? 0 : action;
        counter_.set_output(i, action);
        if ((action != 0) != driving_[i]) {
            driving_[i] = action != 0;
            if (driving_[i]) {
                gpio_.take_over(pins_[i], this, true, cycle);
            } else {
                gpio_.release(pins_[i], cycle, this);
            }
            look_for_observers();
        }
    }
}

bool Timer::pin_level(PinId pin, uint64_t cycle) {
    sync(cycle);
    for (unsigned i = 0; i < channels(); i++) {
        if (pins_[i].port == pin.port && pins_[i].bit == pin.bit) {
            return counter_.level(i);
        }
    }
    return false;
}

double Timer::duty(PinId pin, uint64_t cycle) {
    sync(cycle);
    for (unsigned i = 0; i < channels(); i++) {
        if (driving_[i] && pins_[i].port == pin.port && pins_[i].bit == pin.bit) {
            return counter_.duty(i);
        }
    }
    return -1;
}

void Timer::look_for_observers() {
    is_observed_ = false;
    for (unsigned i = 0; i < channels(); i++) {
        is_observed_ = is_observed_ || (driving_[i] && gpio_.is_observed(pins_[i]));
    }
    note_plain();
}

void Timer::show_outputs(uint64_t cycle) {
    if (is_observed_) {
        for (unsigned i = 0; i < channels(); i++) {
            if (driving_[i]) {
                gpio_.source_changed(pins_[i], cycle);
            }
        }
    }
}

// --- inputs ---

bool Timer::captures() const {
    return is_wide() && (divisor_ != 0 || external_clock_ != 0) && !comparator_captures_;
}

void Timer::watch_inputs(uint64_t cycle) {
    if (number_ != 2) {
        gpio_.watch(kInputs[number_].clock, external_clock_ != 0 ? this : nullptr, true, cycle);
    }
    if (is_wide()) {
        // A pin that floats is not listened to for a flag that nobody waits for.
        const bool is_waited_for = ((byte(mask_register_) | told_flags_) & kFlagCapture) != 0;
        gpio_.watch(kInputs[number_].capture, captures() ? this : nullptr, is_waited_for, cycle);
    }
}

void Timer::pin_changed(PinId pin, uint64_t cycle, bool level) {
    const PinId clock = kInputs[number_].clock;
    if (external_clock_ == 0 || pin.port != clock.port || pin.bit != clock.bit) {
        capture_edge(level, cycle);
    } else if (level == (external_clock_ == 7) && !clock_stands()) {
        advance(1, cycle);
        update_requests();
        show_outputs(cycle);
    }
}

void Timer::capture_from_comparator(bool on, uint64_t cycle) {
    comparator_captures_ = on;
    watch_inputs(cycle);
}

void Timer::capture_edge(bool level, uint64_t cycle) {
    const uint8_t control = byte(control_b());
    if (clock_stands()) {
        return;
    }
    if (level != ((control & kCaptureRising) != 0)) {
        capture_due_ = kNever; // it did not last
        reschedule();
    } else if ((control & kCaptureFiltered) != 0) {
        capture_due_ = cycle + kFilterCycles;
        reschedule();
    } else {
        capture(cycle);
    }
}

void Timer::capture(uint64_t cycle) {
    sync(cycle);
    const uint8_t before = counter_.flags;
    counter_.capture_now();
    if ((counter_.flags & ~before & told_flags_) != 0) {
        on_flags_(cycle);
    }
    update_requests();
}

void Timer::tell_of_flags(uint8_t mask, uint64_t cycle) {
    sync(cycle);
    update_requests(); // for a flag that falls due in this very cycle
    told_flags_ = mask;
    note_plain();
    watch_inputs(cycle);
    reschedule();
}

// --- its clock, and its state ---

void Timer::clock_stops(uint64_t cycle) {
    sync(cycle);
    update_requests();
    core_.schedule.cancel(slot_);
}

void Timer::clock_starts(uint64_t cycle, uint64_t) {
    synced_ = cycle;
    reschedule();
}

void Timer::state(Archive& archive) {
    if (!archive.loading() && divisor_ == 0) { // when somebody looked at a timer that stands tells nothing
        synced_ = core_.cpu.cycle;
    }
    archive(counter_, driving_, temp_, divisor_, synced_, external_clock_, comparator_captures_, capture_due_,
            told_flags_);
    archive.require(
        divisor_ <= 1024 && (divisor_ & (divisor_ - 1)) == 0 &&
            (external_clock_ == 0 || (!has_own_prescaler() && external_clock_ >= 6 && external_clock_ <= 7)),
        "a timer has a clock that there is not");
    archive.require(synced_ <= core_.cpu.cycle, "a timer is ahead of time");
    archive.require(channels() == 3 || !driving_[2], "a timer drives a pin that it has not");
    if (archive.loading()) {
        set_divisor(divisor_);
        for (unsigned i = 0; i < channels(); i++) {
            if (driving_[i]) {
                gpio_.drive_again(pins_[i], this);
            }
        }
        if (external_clock_ != 0) {
            gpio_.watch_again(kInputs[number_].clock, this);
        }
        if (captures()) {
            gpio_.watch_again(kInputs[number_].capture, this);
        }
        look_for_observers();
    }
}

} // namespace tilenca::avr
