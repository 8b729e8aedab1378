#include "avr/self_programming.h"

#include "avr/ops.h"
#include "avr/vectors.h"

#include <cstring>

namespace tilenca::avr {

namespace {

constexpr uint16_t kSpmcsr = 0x57;
constexpr uint8_t kSpmie = 0x80, kRwwsb = 0x40, kRwwsre = 0x10, kBlbset = 0x08, kPgwrt = 0x04, kPgers = 0x02;
constexpr uint8_t kSpmen = 0x01, kCommand = 0x1F;
constexpr uint64_t kArmedCycles = 4;
constexpr uint64_t kPageCycles = 64'000; // 4 ms; timed by the chip's own oscillator

} // namespace

SelfProgramming::SelfProgramming(const Core& core, std::shared_ptr<Program>& program)
    : Peripheral(core), program_(program) {
    std::memset(buffer_, 0xFF, sizeof buffer_);
}

std::vector<uint16_t> SelfProgramming::registers() const {
    return {kSpmcsr};
}

std::vector<uint8_t> SelfProgramming::vectors() const {
    return {kVectorProgramMemory};
}

void SelfProgramming::write(uint16_t, uint8_t value, uint64_t cycle) {
    const uint8_t before = byte(kSpmcsr);
    const bool busy = (before & (kPgwrt | kPgers)) != 0;
    byte(kSpmcsr) =
        static_cast<uint8_t>((before & kRwwsb) | (value & kSpmie) | ((busy ? before : value) & kCommand));
    if (!busy && (value & kSpmen) != 0) {
        armed_until_ = cycle + kArmedCycles;
    }
    update_requests();
}

uint32_t SelfProgramming::execute(uint64_t cycle, bool advance_z) {
    Cpu& cpu = core_.cpu;
    const uint8_t command = byte(kSpmcsr) & kCommand;
    const bool busy = core_.schedule.due(Slot::ProgramMemory) != kNever;
    if (cycle > armed_until_ || busy) {
        return 1;
    }
    const uint32_t z = (cpu.data[ops::kRampZ] & 3u) << 16 | ops::pair(&cpu, ops::kZ);
    if (command == kSpmen) {
        buffer_[z % kPageBytes & ~1u] = cpu.data[0];
        buffer_[z % kPageBytes | 1u] = cpu.data[1];
    } else if (command == (kSpmen | kPgers) || command == (kSpmen | kPgwrt)) {
        change_page(z / kPageBytes * kPageBytes, command == (kSpmen | kPgers));
        byte(kSpmcsr) |= kRwwsb;
        core_.schedule.set(Slot::ProgramMemory, cycle + kPageCycles);
    } else if (command == (kSpmen | kRwwsre)) {
        byte(kSpmcsr) &= static_cast<uint8_t>(~kRwwsb);
        std::memset(buffer_, 0xFF, sizeof buffer_);
    } else if (command == (kSpmen | kBlbset)) {
        core_.warnings.once("lock bits written by SPM: kept out of force");
    }
    armed_until_ = 0;
    if (core_.schedule.due(Slot::ProgramMemory) == kNever) {
        byte(kSpmcsr) &= static_cast<uint8_t>(~kCommand);
    }
    if (advance_z) {
        ops::set_pair(&cpu, ops::kZ, z + 2);
    }
    update_requests();
    return 1;
}

void SelfProgramming::change_page(uint32_t page, bool erase) {
    if (program_.use_count() > 1) {
        program_ = std::make_shared<Program>(*program_);
    }
    uint8_t bytes[kPageBytes];
    for (uint32_t i = 0; i < kPageBytes; i++) {
        bytes[i] = erase ? 0xFF : program_->bytes()[page + i] & buffer_[i]; // writing only clears bits
    }
    program_->write(page, bytes, kPageBytes);
    if (!erase) {
        std::memset(buffer_, 0xFF, sizeof buffer_);
    }
    core_.cpu.use(*program_);
}

void SelfProgramming::on_event(Slot, uint64_t) {
    byte(kSpmcsr) &= static_cast<uint8_t>(~kCommand);
    core_.schedule.cancel(Slot::ProgramMemory);
    update_requests();
}

void SelfProgramming::update_requests() {
    const uint8_t control = byte(kSpmcsr);
    core_.cpu.request(kVectorProgramMemory, (control & kSpmie) != 0 && (control & kSpmen) == 0);
}

void SelfProgramming::reset(uint64_t) {
    armed_until_ = 0;
    core_.schedule.cancel(Slot::ProgramMemory);
}

} // namespace tilenca::avr
