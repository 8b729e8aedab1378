#include "avr/spi.h"

#include "avr/vectors.h"

namespace tilenca::avr {

namespace {

constexpr uint16_t kSpcr = 0x4C, kSpsr = 0x4D, kSpdr = 0x4E;
constexpr uint8_t kSpie = 0x80, kSpe = 0x40, kDord = 0x20, kMstr = 0x10, kCpol = 0x08, kCpha = 0x04;
constexpr uint8_t kSpif = 0x80, kWcol = 0x40, kSpi2x = 0x01;
constexpr uint64_t kDivisors[4] = {4, 16, 64, 128};
constexpr PinId kSs{port_index('B'), 0}, kSck{port_index('B'), 1}, kMosi{port_index('B'), 2},
    kMiso{port_index('B'), 3};

} // namespace

std::vector<uint16_t> Spi::registers() const {
    return {kSpcr, kSpsr, kSpdr};
}

std::vector<uint8_t> Spi::vectors() const {
    return {kVectorSpi};
}

uint64_t Spi::bit_cycles() const {
    const uint64_t divisor = kDivisors[byte(kSpcr) & 3];
    return (byte(kSpsr) & kSpi2x) != 0 ? divisor / 2 : divisor;
}

// SPIF and WCOL fall when SPSR has been read and then SPDR is touched.
uint8_t Spi::read(uint16_t address, uint64_t) {
    if (address == kSpsr) {
        seen_ = done_ || collided_;
        return static_cast<uint8_t>((done_ ? kSpif : 0) | (collided_ ? kWcol : 0) | (byte(kSpsr) & kSpi2x));
    }
    if (address != kSpdr) {
        return byte(address);
    }
    if (seen_) {
        done_ = collided_ = seen_ = false;
        update_requests();
    }
    return received_;
}

void Spi::write(uint16_t address, uint8_t value, uint64_t cycle) {
    if (address == kSpcr) {
        write_control(value, cycle);
    } else if (address == kSpsr) {
        byte(kSpsr) = value & kSpi2x;
    } else if (busy_) {
        collided_ = true;
    } else {
        if (seen_) {
            done_ = collided_ = seen_ = false;
        }
        start(value, cycle);
    }
    update_requests();
}

void Spi::write_control(uint8_t value, uint64_t cycle) {
    const bool was_master = (byte(kSpcr) & (kSpe | kMstr)) == (kSpe | kMstr);
    byte(kSpcr) = value;
    const bool on = (value & kSpe) != 0;
    if (on && (value & kMstr) != 0 && !gpio_.is_output(kSs) && !gpio_.level(kSs, cycle)) {
        byte(kSpcr) &= static_cast<uint8_t>(~kMstr); // another master has selected this chip
        done_ = true;
    }
    if (on && (byte(kSpcr) & kMstr) == 0) {
        core_.warnings.once("SPI as slave (SPCR): nobody clocks it");
    }
    const bool is_master = (byte(kSpcr) & (kSpe | kMstr)) == (kSpe | kMstr);
    if (is_master && !was_master) {
        gpio_.take_over(kMosi, nullptr, gpio_.is_output(kMosi), cycle);
        gpio_.take_over(kSck, nullptr, gpio_.is_output(kSck), cycle);
        gpio_.announce(kSck, cycle, (value & kCpol) != 0);
    } else if (was_master && !is_master) {
        gpio_.release(kMosi, cycle);
        gpio_.release(kSck, cycle);
        busy_ = false;
        core_.schedule.cancel(Slot::Spi);
    }
}

bool Spi::sends_first_bit_lowest() const {
    return (byte(kSpcr) & kDord) != 0;
}

void Spi::start(uint8_t value, uint64_t cycle) {
    if ((byte(kSpcr) & (kSpe | kMstr)) != (kSpe | kMstr)) {
        return;
    }
    sending_ = value;
    started_ = cycle;
    busy_ = true;
    done_ = false;
    show(value, cycle);
    core_.schedule.set(Slot::Spi, cycle + 8 * bit_cycles());
}

// Eight clocks; data change on one edge of SCK and are read on the other.
void Spi::show(uint8_t value, uint64_t cycle) {
    const bool idle = (byte(kSpcr) & kCpol) != 0, late = (byte(kSpcr) & kCpha) != 0;
    const uint64_t bit = bit_cycles(), half = bit / 2;
    for (unsigned i = 0; i < 8; i++) {
        const bool level = (value >> (sends_first_bit_lowest() ? i : 7 - i) & 1) != 0;
        gpio_.announce(kMosi, cycle + i * bit, level);
        gpio_.announce(kSck, cycle + i * bit + (late ? 0 : half), !idle);
        gpio_.announce(kSck, cycle + i * bit + half + (late ? 0 : half), idle);
    }
}

void Spi::on_event(Slot, uint64_t) {
    core_.schedule.cancel(Slot::Spi);
    busy_ = false;
    done_ = true;
    received_ = 0;
    const uint64_t bit = bit_cycles();
    const bool late = (byte(kSpcr) & kCpha) != 0;
    for (unsigned i = 0; i < 8; i++) {
        const uint64_t sampled = started_ + i * bit + (late ? bit - 1 : bit / 2);
        const unsigned place = sends_first_bit_lowest() ? i : 7 - i;
        const bool level = loopback_ ? (sending_ >> place & 1) != 0 : gpio_.input_at(kMiso, sampled);
        received_ = static_cast<uint8_t>(received_ | level << place);
    }
    update_requests();
}

void Spi::interrupt_taken(uint8_t) {
    done_ = false;
    update_requests();
}

void Spi::update_requests() {
    core_.cpu.request(kVectorSpi, done_ && (byte(kSpcr) & kSpie) != 0);
}

void Spi::reset(uint64_t) {
    busy_ = done_ = collided_ = seen_ = false;
    core_.schedule.cancel(Slot::Spi);
}

void Spi::clock_stops(uint64_t) {
    core_.schedule.stop(Slot::Spi);
}

void Spi::clock_starts(uint64_t, uint64_t stood) {
    started_ += busy_ ? stood : 0;
    core_.schedule.go_on(Slot::Spi, stood);
}

void Spi::state(Archive& archive) {
    archive(loopback_, busy_, done_, collided_, seen_, started_, sending_, received_);
}

} // namespace tilenca::avr
