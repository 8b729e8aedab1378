#include "avr/adc.h"

#include "avr/vectors.h"

#include <algorithm>
#include <cmath>

namespace tilenca::avr {

namespace {

constexpr uint16_t kAdcl = 0x78, kAdch = 0x79, kAdcsra = 0x7A, kAdcsrb = 0x7B, kAdmux = 0x7C;
constexpr uint8_t kAden = 0x80, kAdsc = 0x40, kAdate = 0x20, kAdif = 0x10, kAdie = 0x08;
constexpr uint8_t kAdlar = 0x20, kMux5 = 0x08, kTriggerSource = 0x07;
// Conversion times in halves of an ADC clock (data sheet, table 26-1).
constexpr unsigned kFirst = 50, kSingle = 26, kTriggered = 27;
constexpr double kBandgapV = 1.1;

} // namespace

std::vector<uint16_t> Adc::registers() const {
    return {kAdcl, kAdch, kAdcsra, kAdcsrb, kAdmux};
}

std::vector<uint8_t> Adc::vectors() const {
    return {kVectorAdc};
}

// A difference of two channels in halves of the range, as a 10-bit number with sign: data sheet, table 26-4.
double Adc::difference(unsigned mux) const {
    const unsigned half = mux >= 32 ? 8 : 0, code = mux & 31;
    unsigned positive = 0, negative = 0, gain = 1;
    if (code < 16) { // 8 to 15: pairs with an amplifier
        negative = code & 4 ? 2 : 0;
        positive = negative + (code & 1);
        gain = code & 2 ? 200 : 10;
    } else {
        positive = code & 7;
        negative = code < 24 ? 1 : 2;
    }
    const double apart = double(inputs_[half + positive]) - double(inputs_[half + negative]);
    return apart * gain / 2;
}

double Adc::bandgap() const {
    return kBandgapV / supply_v_ * 1024;
}

double Adc::selected() const {
    const unsigned mux = (byte(kAdmux) & 31u) | ((byte(kAdcsrb) & kMux5) != 0 ? 32u : 0u);
    if ((mux & 0x18) == 0) { // single-ended: 0..7, and 32..39 for channels 8..15
        return inputs_[(mux & 7) | (mux >> 2 & 8)];
    }
    if (mux == 0x1E) {
        return bandgap();
    }
    return mux == 0x1F || mux >= 0x3E ? 0 : difference(mux);
}

unsigned Adc::divisor() const {
    const unsigned select = byte(kAdcsra) & 7;
    return 1u << (select == 0 ? 1 : select);
}

// The channel counts as it is chosen now: it may be changed for the next conversion while this one runs.
void Adc::begin(uint64_t cycle) {
    const unsigned mux = (byte(kAdmux) & 31u) | ((byte(kAdcsrb) & kMux5) != 0 ? 32u : 0u);
    is_difference_ = (mux & 0x18) != 0 && mux != 0x1E && mux != 0x1F && mux < 0x3E;
    sampled_ = selected();
    if (by_trigger_) { // an event starts the prescaler anew; a program waits for its next edge
        origin_ = cycle;
    }
    const uint64_t clock = divisor(), late = (cycle - origin_) % clock;
    const uint64_t start = late == 0 ? cycle : cycle + clock - late;
    const unsigned halves = !warm_ ? kFirst : (by_trigger_ ? kTriggered : kSingle);
    core_.schedule.set(Slot::Adc, start + halves * clock / 2);
    warm_ = true;
}

uint8_t Adc::read(uint16_t address, uint64_t) {
    held_ = address == kAdcl || (held_ && address != kAdch);
    return byte(address);
}

bool Adc::reads_as_stored(uint16_t address) const {
    return address != kAdcl && address != kAdch;
}

void Adc::write(uint16_t address, uint8_t value, uint64_t cycle) {
    if (address == kAdcl || address == kAdch) {
        return; // to be read only
    }
    if (address == kAdcsra) {
        write_control(value, cycle);
    } else {
        byte(address) = value;
    }
    if (address == kAdmux) {
        show_result(); // ADLAR acts at once, on a result that is there, too
    }
    setup_changed_(cycle);
}

void Adc::write_control(uint8_t value, uint64_t cycle) {
    const uint8_t before = byte(kAdcsra);
    const auto flag = static_cast<uint8_t>((value & kAdif) != 0 ? 0 : before & kAdif);
    const bool running = (before & kAdsc) != 0;
    byte(kAdcsra) = static_cast<uint8_t>((value & ~kAdif) | flag | (running ? kAdsc : 0));
    if ((value & ~before & kAden) != 0) {
        origin_ = cycle;
    }
    if ((value & kAden) == 0) {
        byte(kAdcsra) &= static_cast<uint8_t>(~kAdsc);
        core_.schedule.cancel(Slot::Adc);
        warm_ = false;
    } else if ((value & kAdsc) != 0 && !running) {
        by_trigger_ = false;
        begin(cycle);
    }
    update_requests();
}

bool Adc::is_triggered_by(AdcTrigger source) const {
    const uint8_t control = byte(kAdcsra);
    return (control & kAden) != 0 && (control & kAdate) != 0 &&
           (byte(kAdcsrb) & kTriggerSource) == static_cast<uint8_t>(source);
}

void Adc::trigger(AdcTrigger source, uint64_t cycle) {
    if (is_triggered_by(source) && (byte(kAdcsra) & kAdsc) == 0) {
        byte(kAdcsra) |= kAdsc;
        by_trigger_ = true;
        begin(cycle);
    }
}

void Adc::start_quietly(uint64_t cycle) {
    if ((byte(kAdcsra) & kAden) != 0 && (byte(kAdcsra) & kAdsc) == 0) {
        byte(kAdcsra) |= kAdsc;
        by_trigger_ = false;
        begin(cycle);
    }
}

void Adc::on_event(Slot, uint64_t cycle) {
    double value = sampled_;
    if (noise_ > 0) {
        value += noise_ * random_.normal();
    }
    const int result = is_difference_ ? std::clamp(int(std::floor(value)), -512, 511) & 0x3FF
                                      : std::clamp(int(std::lround(value)), 0, 1023);
    if (!held_) { // else this result is lost
        result_ = static_cast<uint16_t>(result);
        show_result();
    }
    byte(kAdcsra) |= kAdif;
    if (is_triggered_by(AdcTrigger::FreeRunning)) {
        by_trigger_ = false;
        begin(cycle);
    } else {
        byte(kAdcsra) &= static_cast<uint8_t>(~kAdsc);
        core_.schedule.cancel(Slot::Adc);
    }
    update_requests();
}

void Adc::show_result() {
    const auto shown = static_cast<uint16_t>((byte(kAdmux) & kAdlar) != 0 ? result_ << 6 : result_);
    byte(kAdcl) = static_cast<uint8_t>(shown);
    byte(kAdch) = static_cast<uint8_t>(shown >> 8);
}

void Adc::interrupt_taken(uint8_t) {
    byte(kAdcsra) &= static_cast<uint8_t>(~kAdif);
    update_requests();
}

void Adc::update_requests() {
    const uint8_t control = byte(kAdcsra);
    core_.cpu.request(kVectorAdc, (control & kAdif) != 0 && (control & kAdie) != 0);
}

void Adc::set_noise(double deviation, uint64_t seed) {
    noise_ = deviation;
    random_ = Random(seed);
}

void Adc::reset(uint64_t) {
    warm_ = by_trigger_ = held_ = false;
    result_ = 0;
    core_.schedule.cancel(Slot::Adc);
}

void Adc::clock_stops(uint64_t) {
    core_.schedule.stop(Slot::Adc);
}

void Adc::clock_starts(uint64_t, uint64_t stood) {
    origin_ += stood;
    core_.schedule.go_on(Slot::Adc, stood);
}

void Adc::state(Archive& archive) {
    archive(inputs_, supply_v_, noise_, random_, warm_, by_trigger_, is_difference_, held_, sampled_, result_,
            origin_);
    archive.require(noise_ >= 0 && noise_ <= 1024 && supply_v_ >= 1.8 && supply_v_ <= 5.5 &&
                        std::abs(sampled_) <= 1e6 && result_ <= 1023,
                    "it converts what cannot be");
}

} // namespace tilenca::avr
