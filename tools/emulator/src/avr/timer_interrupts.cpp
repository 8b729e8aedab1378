// A timer's interrupts, and when it next has anything to say.
#include "avr/timer.h"

#include <algorithm>

namespace tilenca::avr {

uint8_t Timer::vector_of(uint8_t flag) const {
    if (flag == kFlagOverflow) {
        return static_cast<uint8_t>(first_vector_ + channels());
    }
    return static_cast<uint8_t>(flag == kFlagCapture ? first_vector_ - 1
                                                     : first_vector_ + __builtin_ctz(flag) - 1);
}

void Timer::update_requests() {
    const uint8_t asking = counter_.flags & byte(mask_register_);
    for (const uint8_t flag : {0x01, 0x02, 0x04, 0x08, 0x20}) {
        if (is_wide() || flag <= 0x04) {
            core_.cpu.request(vector_of(flag), (asking & flag) != 0);
        }
    }
}

void Timer::reschedule() {
    const auto wanted = static_cast<uint8_t>((byte(mask_register_) | told_flags_) & ~counter_.flags);
    uint64_t due = capture_due_;
    if (divisor_ != 0 && !clock_stands()) {
        uint64_t ticks = wanted == 0 ? 0 : counter_.ticks_to_flag(wanted);
        if (is_observed()) {
            const uint64_t change = counter_.ticks_to_change();
            ticks = ticks == 0 ? change : std::min(ticks, change);
        }
        if (ticks != 0) {
            due = std::min(due, (tick_index(synced_) + ticks) * divisor_ + origin_);
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
    for (const uint8_t flag : {0x01, 0x02, 0x04, 0x08, 0x20}) {
        if ((is_wide() || flag <= 0x04) && vector_of(flag) == vector) {
            counter_.flags &= static_cast<uint8_t>(~flag);
        }
    }
    update_requests();
    reschedule();
}

} // namespace tilenca::avr
