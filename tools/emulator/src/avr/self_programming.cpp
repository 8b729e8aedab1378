#include "avr/self_programming.h"

#include "avr/ops.h"
#include "avr/vectors.h"

#include <cstdio>
#include <cstring>

namespace tilenca::avr {

namespace {

constexpr uint16_t kSpmcsr = 0x57;
constexpr uint8_t kSpmie = 0x80, kRwwsb = 0x40, kRwwsre = 0x10, kBlbset = 0x08, kPgwrt = 0x04, kPgers = 0x02;
constexpr uint8_t kSigrd = 0x20, kSpmen = 0x01, kCommand = 0x3F;
constexpr uint64_t kArmedCycles = 4;
constexpr uint64_t kPageCycles = 64'000; // 4 ms; timed by the chip's own oscillator

} // namespace

SelfProgramming::SelfProgramming(const Core& core, std::shared_ptr<Program>& program, Fuses& fuses)
    : Peripheral(core), program_(program), fuses_(fuses) {
    std::memset(buffer_, 0xFF, sizeof buffer_);
}

std::vector<uint16_t> SelfProgramming::registers() const {
    return {kSpmcsr};
}

std::vector<uint8_t> SelfProgramming::vectors() const {
    return {kVectorProgramMemory};
}

// A command stands for four cycles; SPMEN falls by itself if no SPM comes in time.
void SelfProgramming::write(uint16_t, uint8_t value, uint64_t cycle) {
    const uint8_t before = byte(kSpmcsr);
    byte(kSpmcsr) =
        static_cast<uint8_t>((before & kRwwsb) | (value & kSpmie) | ((busy_ ? before : value) & kCommand));
    if (!busy_ && (value & kSpmen) != 0) {
        armed_until_ = cycle + kArmedCycles;
        core_.schedule.set(Slot::ProgramMemory, armed_until_ + 1);
    }
    update_access();
    update_requests();
}

uint32_t SelfProgramming::execute(uint32_t word, uint64_t cycle, bool advance_z) {
    Cpu& cpu = core_.cpu;
    if (word < fuses_.boot_start()) {
        char text[80];
        std::snprintf(text, sizeof text, "SPM outside the boot section (from 0x%05X on): no effect",
                      2 * fuses_.boot_start());
        core_.warnings.once(text);
        return 1;
    }
    if (cycle > armed_until_ || busy_) {
        return 1;
    }
    const uint32_t z = (cpu.data[ops::kRampZ] & 3u) << 16 | ops::pair(&cpu, ops::kZ);
    start(byte(kSpmcsr) & kCommand, z, cycle);
    armed_until_ = 0;
    if (!busy_) {
        finish_command();
    }
    if (advance_z) {
        ops::set_pair(&cpu, ops::kZ, z + 2);
    }
    update_access();
    return 1;
}

void SelfProgramming::start(uint8_t command, uint32_t z, uint64_t cycle) {
    if (command == kSpmen) {
        buffer_[z % kPageBytes & ~1u] = core_.cpu.data[0];
        buffer_[z % kPageBytes | 1u] = core_.cpu.data[1];
        byte(kSpmcsr) &= static_cast<uint8_t>(~kRwwsb); // loading a page opens the flash again
    } else if (command == (kSpmen | kPgers) || command == (kSpmen | kPgwrt)) {
        if (refuses(z)) {
            return;
        }
        change_page(z / kPageBytes * kPageBytes, command == (kSpmen | kPgers));
        byte(kSpmcsr) |= kRwwsb;
        busy_ = true;
        core_.schedule.set(Slot::ProgramMemory, cycle + kPageCycles / core_.cpu.clock_divisor);
    } else if (command == (kSpmen | kRwwsre)) {
        byte(kSpmcsr) &= static_cast<uint8_t>(~kRwwsb);
        std::memset(buffer_, 0xFF, sizeof buffer_);
    } else if (command == (kSpmen | kBlbset)) {
        write_lock();
    }
}

bool SelfProgramming::refuses(uint32_t address) {
    const bool boot = is_boot_section(address);
    if (!fuses_.forbids_writing(boot)) {
        return false;
    }
    char text[96];
    std::snprintf(text, sizeof text,
                  "SPM at flash address 0x%05X in the %s section, which lock bits 0x%02X forbid", address,
                  boot ? "boot" : "application", fuses_.lock);
    core_.cpu.fail(text);
    return true;
}

// R0 brings the new boot lock bits; a lock bit can only be programmed.
void SelfProgramming::write_lock() {
    fuses_.lock &= static_cast<uint8_t>(core_.cpu.data[0] | 0xC3);
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
    changed_ = true;
}

void SelfProgramming::on_event(Slot, uint64_t) {
    finish_command();
    update_access();
}

void SelfProgramming::finish_command() {
    byte(kSpmcsr) &= static_cast<uint8_t>(~kCommand);
    busy_ = false;
    core_.schedule.cancel(Slot::ProgramMemory);
    update_requests();
}

// Whether LPM means the signature, the fuses or the lock bits just now.
bool SelfProgramming::reads_row() const {
    const uint8_t command = byte(kSpmcsr) & kCommand;
    return command == (kSpmen | kBlbset) || command == (kSpmen | kSigrd);
}

uint8_t SelfProgramming::read_row(uint32_t address) const {
    if ((byte(kSpmcsr) & kSigrd) != 0) {
        constexpr uint8_t kRow[6] = {0x1E, kCalibration, 0x98, 0xFF, 0x01, 0xFF};
        return address < 6 ? kRow[address] : 0xFF;
    }
    const uint8_t bytes[4] = {fuses_.low, fuses_.lock, fuses_.extended, fuses_.high};
    return bytes[address & 3];
}

uint8_t SelfProgramming::read_flash(uint32_t word, uint32_t address) {
    if (reads_row()) {
        const uint8_t value = read_row(address);
        finish_command();
        update_access();
        return value;
    }
    const bool from_boot = word >= fuses_.boot_start(), to_boot = is_boot_section(address);
    if (!to_boot && (byte(kSpmcsr) & kRwwsb) != 0) {
        core_.warnings.once("flash read before it was opened again after a page (RWWSRE): reads as 0xFF");
        return 0xFF;
    }
    if (from_boot != to_boot && fuses_.forbids_reading(to_boot)) {
        core_.warnings.once("flash read across sections, which the lock bits forbid: reads as 0xFF");
        return 0xFF;
    }
    return program_->bytes()[address];
}

// Below the boot section flash cannot be read from a page's start until the program asks for it.
void SelfProgramming::update_access() {
    const bool closed = (byte(kSpmcsr) & kRwwsb) != 0 || reads_row() || fuses_.forbids_reading(false);
    core_.cpu.flash = program_->bytes();
    core_.cpu.flash_limit =
        closed ? 0 : (fuses_.forbids_reading(true) ? 2 * fuses_.boot_start() : kFlashBytes);
}

void SelfProgramming::update_requests() {
    const uint8_t control = byte(kSpmcsr);
    core_.cpu.request(kVectorProgramMemory, (control & kSpmie) != 0 && (control & kSpmen) == 0);
}

void SelfProgramming::reset(uint64_t) {
    armed_until_ = 0;
    busy_ = false;
    core_.schedule.cancel(Slot::ProgramMemory);
    update_access();
}

void SelfProgramming::state(Archive& archive) {
    archive.bytes(buffer_, sizeof buffer_);
    archive(armed_until_, busy_, fuses_.low, fuses_.high, fuses_.extended, fuses_.lock);
}

} // namespace tilenca::avr
