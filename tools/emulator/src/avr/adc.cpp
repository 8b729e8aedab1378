#include "avr/adc.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kAdcl = 0x78, kAdch = 0x79, kAdcsra = 0x7A, kAdcsrb = 0x7B, kAdmux = 0x7C;
constexpr uint8_t kAden = 0x80, kAdsc = 0x40, kAdate = 0x20, kAdif = 0x10, kAdie = 0x08;
constexpr uint8_t kAdlar = 0x20, kMux5 = 0x08, kTriggerSource = 0x07; // ADTS: 0 is free running
constexpr unsigned kFirstClocks = 25, kClocks = 13;
constexpr uint16_t kBandgap = 225; // 1.1 V of 5 V

} // namespace

std::vector<uint16_t> Adc::registers() const {
    return {kAdcsra, kAdcsrb};
}

std::vector<uint8_t> Adc::vectors() const {
    return {kVectorAdc};
}

uint16_t Adc::selected() const {
    const unsigned mux = (byte(kAdmux) & 31u) | ((byte(kAdcsrb) & kMux5) != 0 ? 32u : 0u);
    if ((mux & 0x18) == 0) { // single-ended: 0..7, and 32..39 for channels 8..15
        return inputs_[(mux & 7) | (mux >> 2 & 8)];
    }
    if (mux == 0x1E) {
        return kBandgap;
    }
    if (mux != 0x1F) {
        core_.warnings.once("differential ADC channels: convert to 0");
    }
    return 0;
}

void Adc::start(uint64_t cycle, unsigned adc_clocks) {
    const unsigned select = byte(kAdcsra) & 7;
    const unsigned divisor = 1u << (select == 0 ? 1 : select);
    core_.schedule.set(Slot::Adc, cycle + uint64_t{adc_clocks} * divisor);
}

void Adc::write(uint16_t address, uint8_t value, uint64_t cycle) {
    if (address == kAdcsrb) {
        byte(kAdcsrb) = value;
    } else {
        write_control(value, cycle);
    }
    if ((byte(kAdcsra) & kAdate) != 0 && (byte(kAdcsrb) & kTriggerSource) != 0) {
        core_.warnings.once("ADC triggered by another event than its own end (ADTS): nothing starts it");
    }
}

void Adc::write_control(uint8_t value, uint64_t cycle) {
    const uint8_t before = byte(kAdcsra);
    const auto flag = static_cast<uint8_t>((value & kAdif) != 0 ? 0 : before & kAdif);
    const bool running = (before & kAdsc) != 0;
    byte(kAdcsra) = static_cast<uint8_t>((value & ~kAdif) | flag | (running ? kAdsc : 0));
    if ((value & kAden) == 0) {
        byte(kAdcsra) &= static_cast<uint8_t>(~kAdsc);
        core_.schedule.cancel(Slot::Adc);
        warm_ = false;
    } else if ((value & kAdsc) != 0 && !running) {
        start(cycle, warm_ ? kClocks : kFirstClocks);
        warm_ = true;
    }
    update_requests();
}

void Adc::on_event(Slot, uint64_t cycle) {
    const uint16_t value = selected();
    const auto shown = static_cast<uint16_t>((byte(kAdmux) & kAdlar) != 0 ? value << 6 : value);
    byte(kAdcl) = static_cast<uint8_t>(shown);
    byte(kAdch) = static_cast<uint8_t>(shown >> 8);
    byte(kAdcsra) |= kAdif;
    const bool free_running = (byte(kAdcsra) & kAdate) != 0 && (byte(kAdcsrb) & kTriggerSource) == 0;
    if (free_running) {
        start(cycle, kClocks);
    } else {
        byte(kAdcsra) &= static_cast<uint8_t>(~kAdsc);
        core_.schedule.cancel(Slot::Adc);
    }
    update_requests();
}

void Adc::interrupt_taken(uint8_t) {
    byte(kAdcsra) &= static_cast<uint8_t>(~kAdif);
    update_requests();
}

void Adc::update_requests() {
    const uint8_t control = byte(kAdcsra);
    core_.cpu.request(kVectorAdc, (control & kAdif) != 0 && (control & kAdie) != 0);
}

void Adc::reset(uint64_t) {
    warm_ = false;
    core_.schedule.cancel(Slot::Adc);
}

} // namespace tilenca::avr
