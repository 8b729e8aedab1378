#include "board/boot.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>
#include <stddef.h>

#include "board/boot_layout.h"
#include "core/crc32.h"

// From the linker: where variables end and the stack's room begins.
extern "C" uint8_t __heap_start;

namespace tilenca {
namespace board {

namespace {

uint8_t inferred_cause(uint32_t mark) {
    return mark == MARK_HUNG ? 1 << WDRF : mark == MARK_RUNNING ? 1 << EXTRF : 1 << PORF;
}

} // namespace

// In SRAM that nobody clears: it outlives a reset, but not a loss of power.
struct Survivors {
    uint32_t mark;
    uint8_t cause;
    uint8_t hung_at[3]; // word address, low byte first
};
static_assert(offsetof(Survivors, mark) == SURVIVORS_MARK && offsetof(Survivors, cause) == SURVIVORS_CAUSE &&
                  offsetof(Survivors, hung_at) == SURVIVORS_HUNG_AT && sizeof(Survivors) == SURVIVORS_BYTES,
              "avr/boot.S");

extern "C" {
__attribute__((section(".noinit"))) volatile Survivors tilenca_survivors;

// avr/boot.S calls this with the value of MCUSR, before any variable has its initial value.
__attribute__((used)) void tilenca_survive(uint8_t cause) {
    const uint32_t mark = tilenca_survivors.mark;
    tilenca_survivors.cause = cause != 0 ? cause : inferred_cause(mark);
    if (mark != MARK_HUNG) {
        tilenca_survivors.hung_at[0] = tilenca_survivors.hung_at[1] = tilenca_survivors.hung_at[2] = 0;
    }
    tilenca_survivors.mark = MARK_RUNNING;
}
}

uint8_t reset_cause() {
    return tilenca_survivors.cause;
}

uint32_t hung_at() {
    const uint32_t word = tilenca_survivors.hung_at[0] |
                          static_cast<uint16_t>(tilenca_survivors.hung_at[1]) << 8 |
                          static_cast<uint32_t>(tilenca_survivors.hung_at[2]) << 16;
    return 2 * word;
}

namespace {

constexpr uint32_t kBootSection = 0x3E000;

// Reads bytes of flash and advances `address`.
void read_flash(uint32_t* address, uint8_t* bytes, uint8_t size) {
    RAMPZ = static_cast<uint8_t>(*address >> 16);
    uint16_t low = static_cast<uint16_t>(*address);
    for (uint8_t i = 0; i < size; ++i) {
        __asm__ volatile("elpm %0, Z+" : "=r"(bytes[i]), "+z"(low));
    }
    *address += size;
}

// The end of the image, which is the program and the initial values of the variables.
uint32_t image_end() {
    uint32_t end;
    __asm__("ldi %A0, lo8(__data_load_end) \n\t"
            "ldi %B0, hi8(__data_load_end) \n\t"
            "ldi %C0, hh8(__data_load_end) \n\t"
            "clr %D0 \n\t"
            : "=d"(end));
    return end;
}

} // namespace

uint32_t firmware_id() {
    const uint32_t end = image_end();
    Crc32 crc;
    uint8_t bytes[32];
    for (uint32_t at = 0; at < end;) {
        const uint32_t left = end - at;
        const uint8_t size = left < sizeof bytes ? static_cast<uint8_t>(left) : sizeof bytes;
        read_flash(&at, bytes, size);
        crc.add(bytes, size);
    }
    return crc.value();
}

uint32_t bootloader_id() {
    Crc32 crc;
    uint8_t bytes[32];
    bool erased = true;
    for (uint32_t at = kBootSection; at <= FLASHEND;) {
        read_flash(&at, bytes, sizeof bytes);
        crc.add(bytes, sizeof bytes);
        for (uint8_t byte : bytes) {
            erased &= byte == 0xFF;
        }
    }
    return erased ? 0 : crc.value();
}

// Interrupt first, and reset only if the interrupt does not come through: old boot loaders of the Mega leave
// the watchdog on, which then resets them again and again before they have started anything.
void watchdog_begin() {
    const uint8_t interrupts = SREG;
    cli();
    wdt_reset();
    WDTCSR = 1 << WDCE | 1 << WDE;
    WDTCSR = 1 << WDIE | 1 << WDE | 1 << WDP2; // 0.25 s
    SREG = interrupts;
}

void watchdog_feed() {
    wdt_reset();
}

namespace {

constexpr uint8_t kLookedAtPerTurn = 4;
uint8_t* looking_at = &__heap_start;
uint16_t unused = 0xFFFF;

} // namespace

bool stack_watch() {
    for (uint8_t i = 0; i < kLookedAtPerTurn; ++i) {
        if (*looking_at != STACK_PAINT) {
            unused = static_cast<uint16_t>(looking_at - &__heap_start);
            looking_at = &__heap_start;
            return true;
        }
        ++looking_at;
    }
    return false;
}

uint16_t stack_unused() {
    return unused;
}

} // namespace board
} // namespace tilenca
