// A timer's interrupts, and when it next has anything to say.
#include "avr/timer.h"

#include <algorithm>

namespace tilenca::avr {

namespace {

constexpr uint8_t kWideFlags = 0x2F, kNarrowFlags = 0x07;
constexpr unsigned kOverflowBit = 0, kFirstCompareBit = 1, kCaptureBit = 5;

} // namespace

// Vectors in order: capture (wide timers only), the compare units, overflow.
void Timer::update_requests() {
    const unsigned asking = counter_.flags & byte(mask_register_) & (is_wide() ? kWideFlags : kNarrowFlags);
    const unsigned units = channels(), all_units = (1u << units) - 1;
    const uint64_t compares = asking >> kFirstCompareBit & all_units;
    const uint64_t overflow = asking >> kOverflowBit & 1, capture = asking >> kCaptureBit & 1;
    const uint64_t from_compare = compares | overflow << units;
    const uint64_t all = (uint64_t{2} << units) - 1;
    if (is_wide()) {
        core_.cpu.request_all((all << 1 | 1) << (first_vector_ - 1), (from_compare << 1 | capture)
                                                                         << (first_vector_ - 1));
    } else {
        core_.cpu.request_all(all << first_vector_, from_compare << first_vector_);
    }
}

// A flag that is set already counts as well: so nothing moves when an interrupt is taken.
void Timer::reschedule() {
    const auto wanted = static_cast<uint8_t>(byte(mask_register_) | told_flags_);
    uint64_t due = capture_due_;
    if (divisor_ != 0 && !clock_stands()) {
        uint64_t ticks = wanted == 0 ? 0 : counter_.ticks_to_flag(wanted);
        if (is_observed_) {
            const uint64_t change = counter_.ticks_to_change();
            ticks = ticks == 0 ? change : std::min(ticks, change);
        }
        if (ticks != 0) {
            due = std::min(due, prescaler_.when((tick_index(synced_) + ticks) << shift_));
        }
    }
    core_.schedule.set(slot_, due);
}

void Timer::on_event(Slot, uint64_t cycle) {
    if (cycle >= capture_due_) {
        capture_due_ = kNever;
        capture(cycle);
    }
    sync(cycle);
    update_requests();
    reschedule();
    show_outputs(cycle);
}

void Timer::interrupt_taken(uint8_t vector) {
    const unsigned place = vector + 1u - first_vector_; // 0: capture
    const unsigned bit = place == 0 ? kCaptureBit : (place > channels() ? kOverflowBit : place);
    counter_.flags &= static_cast<uint8_t>(~(1u << bit));
    update_requests();
}

} // namespace tilenca::avr
