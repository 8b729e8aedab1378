#include "avr/timer.h"

#include "avr/timer_registers.h"
#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

struct Place {
    uint16_t base, flags, mask;
    uint8_t compare_vector;
    PinId pins[3];
};

constexpr PinId pin(char port, uint8_t bit) {
    return {port_index(port), bit};
}

constexpr Place kPlaces[6] = {
    {0x44, 0x35, 0x6E, kVectorTimer0CompareA, {pin('B', 7), pin('G', 5), {}}},
    {0x80, 0x36, 0x6F, kVectorTimer1Capture + 1, {pin('B', 5), pin('B', 6), pin('B', 7)}},
    {0xB0, 0x37, 0x70, kVectorTimer2CompareA, {pin('B', 4), pin('H', 6), {}}},
    {0x90, 0x38, 0x71, kVectorTimer3Capture + 1, {pin('E', 3), pin('E', 4), pin('E', 5)}},
    {0xA0, 0x39, 0x72, kVectorTimer4Capture + 1, {pin('H', 3), pin('H', 4), pin('H', 5)}},
    {0x120, 0x3A, 0x73, kVectorTimer5Capture + 1, {pin('L', 3), pin('L', 4), pin('L', 5)}},
};

constexpr uint32_t kDivisors[8] = {0, 1, 8, 64, 256, 1024, 0, 0};
constexpr uint32_t kTimer2Divisors[8] = {0, 1, 8, 32, 64, 128, 256, 1024};

constexpr WaveMode kNarrowModes[8] = {
    {Wave::Normal, Top::Fixed, 0xFF}, {Wave::PhaseCorrect, Top::Fixed, 0xFF},
    {Wave::Ctc, Top::CompareA, 0},    {Wave::Fast, Top::Fixed, 0xFF},
    {Wave::Normal, Top::Fixed, 0xFF}, {Wave::PhaseCorrect, Top::CompareA, 0},
    {Wave::Normal, Top::Fixed, 0xFF}, {Wave::Fast, Top::CompareA, 0},
};

constexpr WaveMode kWideModes[16] = {
    {Wave::Normal, Top::Fixed, 0xFFFF},
    {Wave::PhaseCorrect, Top::Fixed, 0xFF},
    {Wave::PhaseCorrect, Top::Fixed, 0x1FF},
    {Wave::PhaseCorrect, Top::Fixed, 0x3FF},
    {Wave::Ctc, Top::CompareA, 0},
    {Wave::Fast, Top::Fixed, 0xFF},
    {Wave::Fast, Top::Fixed, 0x1FF},
    {Wave::Fast, Top::Fixed, 0x3FF},
    {Wave::PhaseAndFrequencyCorrect, Top::Capture, 0},
    {Wave::PhaseAndFrequencyCorrect, Top::CompareA, 0},
    {Wave::PhaseCorrect, Top::Capture, 0},
    {Wave::PhaseCorrect, Top::CompareA, 0},
    {Wave::Ctc, Top::Capture, 0},
    {Wave::Normal, Top::Fixed, 0xFFFF},
    {Wave::Fast, Top::Capture, 0},
    {Wave::Fast, Top::CompareA, 0},
};

} // namespace

Timer::Timer(const Core& core, Gpio& gpio, Prescaler& prescaler, unsigned number)
    : Peripheral(core), gpio_(gpio), prescaler_(prescaler), number_(number), base_(kPlaces[number].base),
      flag_register_(kPlaces[number].flags), mask_register_(kPlaces[number].mask),
      first_vector_(kPlaces[number].compare_vector), slot_(Slot::Timer0 + number),
      counter_(is_wide() ? 0xFFFF : 0xFF, is_wide() ? 3 : 2) {
    for (unsigned i = 0; i < channels(); i++) {
        pins_[i] = kPlaces[number].pins[i];
    }
}

std::vector<uint16_t> Timer::registers() const {
    std::vector<uint16_t> all = {flag_register_, mask_register_};
    for (unsigned offset = 0; offset < (is_wide() ? kWideEnd : kNarrowEnd); offset++) {
        if (!is_wide() || offset != 3) {
            all.push_back(static_cast<uint16_t>(base_ + offset));
        }
    }
    return all;
}

std::vector<uint8_t> Timer::vectors() const {
    std::vector<uint8_t> all;
    for (unsigned v = is_wide() ? first_vector_ - 1u : first_vector_; v <= first_vector_ + channels(); v++) {
        all.push_back(static_cast<uint8_t>(v));
    }
    return all;
}

void Timer::sync(uint64_t cycle) {
    if (lent_ != 0) {
        take_back();
    }
    if (clock_stands()) {
        return;
    }
    if (divisor_ != 0 && cycle > synced_) {
        if (const uint64_t ticks = tick_index(cycle) - tick_index(synced_); ticks != 0) {
            advance(ticks, cycle);
        }
    }
    synced_ = cycle > synced_ ? cycle : synced_;
}

void Timer::advance(uint64_t ticks, uint64_t cycle) {
    const uint8_t before = counter_.flags;
    counter_.advance(ticks);
    if ((counter_.flags & ~before & told_flags_) != 0) {
        on_flags_(cycle);
    }
}

uint8_t Timer::read(uint16_t address, uint64_t cycle) {
    if (reads_as_stored(address)) {
        return byte(address);
    }
    sync(cycle);
    if (address == flag_register_) {
        return counter_.flags;
    }
    return read_value(address - base_);
}

// Compare registers, too: their bytes are stored beside the counter's values.
bool Timer::reads_as_stored(uint16_t address) const {
    const unsigned offset = static_cast<unsigned>(address) - base_; // large for those below
    const bool is_control = offset < (is_wide() ? kWideCount : kNarrowCount);
    const bool is_compare = offset - first_compare() < (is_wide() ? kWideEnd : kNarrowEnd) - first_compare();
    return address == mask_register_ || is_control || is_compare;
}

uint8_t Timer::read_value(unsigned offset) {
    if (!is_wide()) {
        return static_cast<uint8_t>(counter_.count());
    }
    if ((offset & 1) != 0) {
        return temp_;
    }
    const uint16_t value = offset == kWideCount ? counter_.count() : counter_.capture();
    temp_ = static_cast<uint8_t>(value >> 8);
    return static_cast<uint8_t>(value);
}

// A register has its new value from the cycle after the write on. The tick between the two still counts with
// the old one, and a count that is written takes the place of that tick's.
void Timer::write(uint16_t address, uint8_t value, uint64_t cycle) {
    const unsigned first_value = is_wide() ? kWideCount : kNarrowCount;
    if (address == flag_register_) { // a flag that this tick raises stays
        sync(cycle);
        counter_.flags &= static_cast<uint8_t>(~value);
        update_requests();
        reschedule();
        return;
    }
    if (const unsigned offset = address - base_; offset < kNarrowEnd && (plain_ >> offset & 1) != 0) {
        write_plainly(offset, value);
        lend(offset);
        return;
    }
    cycle++;
    sync(cycle);
    if (address == mask_register_) {
        byte(address) = value;
        watch_inputs(cycle);
        note_plain();
    } else if (address < base_ + first_value) {
        write_control(address, value, cycle);
        note_plain();
    } else {
        const unsigned offset = address - base_;
        if (is_wide() && (offset & 1) != 0) { // waits for the low byte, and nothing has changed yet
            temp_ = value;
            return;
        }
        write_value(offset, value);
        if (offset >= first_compare() && !compare_matters(offset - first_compare())) {
            return;
        }
    }
    update_requests();
    reschedule();
    show_outputs(cycle);
}

unsigned Timer::first_compare() const {
    return is_wide() ? kWideCompare : kNarrowCompare;
}

void Timer::write_value(unsigned offset, uint8_t value) {
    if (is_wide()) {
        write_wide(offset, static_cast<uint16_t>(temp_ << 8 | value));
    } else if (offset == kNarrowCount) {
        counter_.set_count(value);
    } else {
        set_compare(offset - kNarrowCompare, value);
    }
}

void Timer::set_compare(unsigned channel, uint16_t value) {
    value &= counter_.compare_mask();
    counter_.set_compare(channel, value);
    const auto place = static_cast<uint16_t>(base_ + first_compare() + (is_wide() ? 2 * channel : channel));
    byte(place) = static_cast<uint8_t>(value);
    if (is_wide()) {
        byte(static_cast<uint16_t>(place + 1)) = static_cast<uint8_t>(value >> 8);
    }
    if (driving_[channel]) {
        gpio_.note_shown(pins_[channel]);
    }
}

void Timer::write_wide(unsigned offset, uint16_t value) {
    if (offset == kWideCount) {
        counter_.set_count(value);
    } else if (offset == kWideCapture) {
        counter_.set_capture(value); // in any mode, whatever the data sheet says: a chip was asked
    } else {
        set_compare((offset - kWideCompare) / 2, value);
    }
}

void Timer::write_control(uint16_t address, uint8_t value, uint64_t cycle) {
    const unsigned force_at = is_wide() ? kWideForce : 1;
    if (address == base_ + force_at) {
        for (unsigned i = 0; i < channels(); i++) {
            if ((value & 0x80 >> i) != 0 && counter_.mode().wave < Wave::Fast) {
                counter_.force_compare(i);
            }
        }
        value &= is_wide() ? 0x00 : 0x0F; // the force bits read as zero
    }
    byte(address) = value;
    apply_mode();
    apply_outputs(cycle);
    if (address == control_b()) {
        apply_clock(cycle);
    }
}

void Timer::apply_mode() {
    const uint8_t low = byte(control_a()) & 3;
    counter_.set_mode(is_wide() ? kWideModes[low | (byte(control_b()) >> 1 & 12)]
                                : kNarrowModes[low | (byte(control_b()) >> 1 & 4)]);
}

void Timer::apply_clock(uint64_t cycle) {
    const uint8_t select = byte(control_b()) & 7;
    set_divisor(number_ == 2 ? kTimer2Divisors[select] : kDivisors[select]);
    external_clock_ = number_ != 2 && select >= 6 ? select : 0;
    watch_inputs(cycle);
}

void Timer::set_divisor(uint32_t divisor) {
    divisor_ = divisor;
    shift_ = static_cast<uint8_t>(divisor == 0 ? 0 : __builtin_ctz(divisor));
}

void Timer::reset(uint64_t cycle) {
    counter_.reset();
    counter_.set_mode(is_wide() ? kWideModes[0] : kNarrowModes[0]);
    driving_.fill(false);
    is_observed_ = false;
    temp_ = 0;
    set_divisor(0);
    external_clock_ = 0;
    comparator_captures_ = false;
    capture_due_ = kNever;
    told_flags_ = 0;
    synced_ = cycle;
    core_.schedule.cancel(slot_);
    note_plain();
}

} // namespace tilenca::avr
