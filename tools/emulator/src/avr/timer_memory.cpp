// The registers of a timer that stands, in which programs keep variables: then they are no more than memory.
#include "avr/timer.h"

#include "avr/timer_registers.h"

#include <utility>

namespace tilenca::avr {

bool Timer::is_memory_at_times(uint16_t address) const {
    const unsigned offset = static_cast<unsigned>(address) - base_;
    return !is_wide() && offset >= kNarrowCount && offset < kNarrowEnd;
}

// While it stands, and in most modes, nothing but its value comes of a write to some registers.
void Timer::note_plain() {
    take_back();
    plain_ = 0;
    if (divisor_ == 0 && !is_wide() && !is_observed_) {
        plain_ = 1 << kNarrowCount;
        for (unsigned i = 0; i < channels(); i++) {
            plain_ |= static_cast<uint8_t>(!compare_matters(i) << (kNarrowCompare + i));
        }
    }
}

void Timer::write_plainly(unsigned offset, uint8_t value) {
    if (offset == kNarrowCount) {
        counter_.set_count(value);
    } else {
        counter_.set_compare(offset - kNarrowCompare, value);
        byte(static_cast<uint16_t>(base_ + offset)) = value;
    }
}

// A register that was written so is memory from then on, which costs nothing, until anybody needs its value
// or more could come of a write.
void Timer::lend(unsigned offset) {
    if (external_clock_ == 0) {
        const auto address = static_cast<uint16_t>(base_ + offset);
        byte(address) = static_cast<uint8_t>(offset == kNarrowCount ? counter_.count() : byte(address));
        core_.cpu.special[address] = kChangesItsWay;
        lent_ |= static_cast<uint8_t>(1 << offset);
    }
}

void Timer::take_back() {
    for (unsigned lent = std::exchange(lent_, uint8_t{0}); lent != 0; lent &= lent - 1) {
        const auto offset = static_cast<unsigned>(__builtin_ctz(lent));
        const auto address = static_cast<uint16_t>(base_ + offset);
        const bool is_count = offset == kNarrowCount; // which has no byte of its own
        core_.cpu.special[address] |= kWritesThroughBus | (is_count ? kReadsThroughBus : 0);
        write_plainly(offset, byte(address));
        byte(address) = is_count ? uint8_t{0} : byte(address);
    }
}

// Whether anything but a flag that nobody waits for can come of a compare register's new value.
bool Timer::compare_matters(unsigned offset) const {
    const unsigned channel = is_wide() ? offset / 2 : offset;
    const bool is_waited_for = ((byte(mask_register_) | told_flags_) & kFlagCompareA << channel) != 0;
    const WaveMode& mode = counter_.mode();
    return is_waited_for || driving_[channel] || mode.top == Top::CompareA || mode.wave >= Wave::Fast;
}

} // namespace tilenca::avr
