#include "avr/twi.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kTwbr = 0xB8, kTwsr = 0xB9, kTwdr = 0xBB, kTwcr = 0xBC;
constexpr uint8_t kTwint = 0x80, kTwsta = 0x20, kTwsto = 0x10, kTwwc = 0x08, kTwen = 0x04, kTwie = 0x01;
constexpr uint8_t kTwps = 0x03;
// Status codes (data sheet, tables 24-3 and 24-4).
constexpr uint8_t kStarted = 0x08, kStartedAgain = 0x10, kWriteRefused = 0x20, kDataRefused = 0x30;
constexpr uint8_t kReadRefused = 0x48, kLastDataRead = 0x58, kNothing = 0xF8;
constexpr unsigned kByteBits = 9; // with its acknowledge

} // namespace

std::vector<uint16_t> Twi::registers() const {
    return {kTwsr, kTwdr, kTwcr};
}

std::vector<uint8_t> Twi::vectors() const {
    return {kVectorTwi};
}

// Data sheet, section 24.5.2: SCL runs at the CPU's clock / (16 + 2 TWBR 4^TWPS).
uint64_t Twi::bit_cycles() const {
    return 16 + 2 * (uint64_t{byte(kTwbr)} << 2 * (byte(kTwsr) & kTwps));
}

void Twi::set_status(uint8_t code) {
    byte(kTwsr) = static_cast<uint8_t>((byte(kTwsr) & kTwps) | code);
}

void Twi::write(uint16_t address, uint8_t value, uint64_t cycle) {
    if (address == kTwsr) {
        byte(kTwsr) = static_cast<uint8_t>((byte(kTwsr) & ~kTwps) | (value & kTwps));
    } else if (address == kTwdr) {
        if ((byte(kTwcr) & kTwint) != 0) {
            byte(kTwdr) = value;
        } else {
            byte(kTwcr) |= kTwwc; // only while TWINT is set
        }
    } else {
        const uint8_t before = byte(kTwcr);
        byte(kTwcr) = static_cast<uint8_t>((value & ~(kTwint | kTwwc)) | (before & kTwint));
        if ((value & kTwen) == 0) {
            reset(cycle);
        } else if ((value & kTwint) != 0) {
            byte(kTwcr) &= static_cast<uint8_t>(~kTwint);
            go_on(value, cycle);
        }
    }
    update_requests();
}

// Clearing TWINT starts what the other bits and the state ask for.
void Twi::go_on(uint8_t control, uint64_t cycle) {
    if ((control & kTwsto) != 0) {
        coming_ = 0;
        core_.schedule.set(Slot::Twi, cycle + bit_cycles());
    } else if ((control & kTwsta) != 0) {
        coming_ = phase_ == Phase::Idle ? kStarted : kStartedAgain;
        core_.schedule.set(Slot::Twi, cycle + bit_cycles());
    } else if (phase_ == Phase::Started) {
        const bool reads = (byte(kTwdr) & 1) != 0;
        phase_ = reads ? Phase::Reading : Phase::Writing;
        coming_ = reads ? kReadRefused : kWriteRefused;
        core_.schedule.set(Slot::Twi, cycle + kByteBits * bit_cycles());
    } else if (phase_ != Phase::Idle) {
        coming_ = phase_ == Phase::Reading ? kLastDataRead : kDataRefused;
        core_.schedule.set(Slot::Twi, cycle + kByteBits * bit_cycles());
    }
}

void Twi::on_event(Slot, uint64_t cycle) {
    core_.schedule.cancel(Slot::Twi);
    if (coming_ == 0) { // a stop raises no flag; a start asked for along with it follows
        byte(kTwcr) &= static_cast<uint8_t>(~kTwsto);
        phase_ = Phase::Idle;
        set_status(kNothing);
        if ((byte(kTwcr) & kTwsta) != 0) {
            go_on(byte(kTwcr), cycle);
        }
        return;
    }
    set_status(coming_);
    if (coming_ == kStarted || coming_ == kStartedAgain) {
        phase_ = Phase::Started;
    } else if (coming_ == kLastDataRead) {
        byte(kTwdr) = 0xFF; // nobody pulls the line down
    }
    byte(kTwcr) |= kTwint;
    update_requests();
}

// Unlike other flags, TWINT stays set when its interrupt is taken.
void Twi::update_requests() {
    core_.cpu.request(kVectorTwi, (byte(kTwcr) & (kTwint | kTwie)) == (kTwint | kTwie));
}

void Twi::reset(uint64_t) {
    core_.schedule.cancel(Slot::Twi);
    phase_ = Phase::Idle;
    set_status(kNothing);
    byte(kTwcr) &= static_cast<uint8_t>(~(kTwint | kTwsta | kTwsto));
}

void Twi::clock_stops(uint64_t) {
    core_.schedule.stop(Slot::Twi);
}

void Twi::clock_starts(uint64_t, uint64_t stood) {
    core_.schedule.go_on(Slot::Twi, stood);
}

void Twi::state(Archive& archive) {
    archive(phase_, coming_);
}

} // namespace tilenca::avr
