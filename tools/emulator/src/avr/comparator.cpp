#include "avr/comparator.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kAcsr = 0x50, kPrr0 = 0x64, kAdcsra = 0x7A, kAdcsrb = 0x7B, kAdmux = 0x7C;
constexpr uint8_t kAcd = 0x80, kAcbg = 0x40, kAco = 0x20, kAci = 0x10, kAcie = 0x08, kAcic = 0x04;
constexpr uint8_t kAcis = 0x03, kAcme = 0x40, kAden = 0x80, kMux5 = 0x08, kPradc = 0x01;

} // namespace

std::vector<uint16_t> Comparator::registers() const {
    return {kAcsr};
}

std::vector<uint8_t> Comparator::vectors() const {
    return {kVectorComparator};
}

bool Comparator::compare() const {
    if ((byte(kAcsr) & kAcd) != 0) {
        return false;
    }
    const uint16_t positive = (byte(kAcsr) & kAcbg) != 0 ? static_cast<uint16_t>(adc_.bandgap()) : inputs_[0];
    uint16_t negative = inputs_[1];
    const bool has_multiplexer = (byte(kAdcsra) & kAden) == 0 && (byte(kPrr0) & kPradc) == 0;
    if ((byte(kAdcsrb) & kAcme) != 0 && has_multiplexer) {
        negative = adc_.input((byte(kAdmux) & 7u) | ((byte(kAdcsrb) & kMux5) != 0 ? 8u : 0u));
    }
    return positive > negative;
}

void Comparator::inputs_changed(uint64_t cycle) {
    const bool before = output_;
    output_ = compare();
    if (output_ == before) {
        return;
    }
    changed_(output_, cycle);
    const uint8_t how = byte(kAcsr) & kAcis; // 0 toggle, 2 falling, 3 rising
    if (how == 0 || how == (output_ ? 3 : 2)) {
        byte(kAcsr) |= kAci;
    }
    update_requests();
}

uint8_t Comparator::read(uint16_t, uint64_t cycle) {
    inputs_changed(cycle); // power reduction may have taken the multiplexer away
    return static_cast<uint8_t>((byte(kAcsr) & ~kAco) | (output_ ? kAco : 0));
}

void Comparator::write(uint16_t, uint8_t value, uint64_t cycle) {
    const auto flag = static_cast<uint8_t>((value & kAci) != 0 ? 0 : byte(kAcsr) & kAci);
    byte(kAcsr) = static_cast<uint8_t>((value & ~(kAci | kAco)) | flag);
    setup_(cycle);
    inputs_changed(cycle);
    update_requests();
}

bool Comparator::captures() const {
    return (byte(kAcsr) & kAcic) != 0;
}

void Comparator::set_inputs(uint16_t ain0, uint16_t ain1, uint64_t cycle) {
    inputs_ = {ain0, ain1};
    inputs_changed(cycle);
}

void Comparator::interrupt_taken(uint8_t) {
    byte(kAcsr) &= static_cast<uint8_t>(~kAci);
    update_requests();
}

void Comparator::update_requests() {
    core_.cpu.request(kVectorComparator, (byte(kAcsr) & (kAci | kAcie)) == (kAci | kAcie));
}

void Comparator::reset(uint64_t) {
    output_ = compare();
}

void Comparator::state(Archive& archive) {
    archive(inputs_, output_);
}

} // namespace tilenca::avr
