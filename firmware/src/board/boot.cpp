#include "board/boot.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

#include "core/crc32.h"

// Where variables end and the stack's room begins; the linker's.
extern "C" uint8_t __heap_start;

namespace tilenca {
namespace board {

namespace {

constexpr uint8_t kPaint = 0xC5;

// What outlives a reset, but not a loss of power, in SRAM that nobody clears.
constexpr uint32_t kRunning = 0x52554E21;
constexpr uint32_t kHung = 0x48554E47;
struct Kept {
    uint32_t mark;
    uint8_t cause;
    uint8_t hung_at[3]; // word address, low byte first
};
__attribute__((section(".noinit"))) volatile Kept kept;

uint8_t inferred_cause(uint32_t mark) {
    return mark == kHung ? 1 << WDRF : mark == kRunning ? 1 << EXTRF : 1 << PORF;
}

// Before the start-up code clears memory, with nothing on the stack yet.
__attribute__((naked, used, section(".init3"))) void start() {
    const uint8_t cause = MCUSR;
    MCUSR = 0;
    wdt_disable(); // a watchdog that has reset the chip runs on
    kept.cause = cause != 0 ? cause : inferred_cause(kept.mark);
    if (kept.mark != kHung) {
        kept.hung_at[0] = kept.hung_at[1] = kept.hung_at[2] = 0;
    }
    kept.mark = kRunning;
    for (uint8_t* at = &__heap_start; at <= reinterpret_cast<uint8_t*>(RAMEND); ++at) {
        *at = kPaint;
    }
}

} // namespace

uint8_t reset_cause() {
    return kept.cause;
}

uint32_t hung_at() {
    const uint32_t word = kept.hung_at[0] | static_cast<uint16_t>(kept.hung_at[1]) << 8 |
                          static_cast<uint32_t>(kept.hung_at[2]) << 16;
    return 2 * word;
}

namespace {

// The bytes of flash from here on; `address` moves on.
void read_flash(uint32_t* address, uint8_t* bytes, uint8_t size) {
    RAMPZ = static_cast<uint8_t>(*address >> 16);
    uint16_t low = static_cast<uint16_t>(*address);
    for (uint8_t i = 0; i < size; ++i) {
        __asm__ volatile("elpm %0, Z+" : "=r"(bytes[i]), "+z"(low));
    }
    *address += size;
}

// One byte after the last of the image: the program, then the variables' initial values.
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

// Interrupt first, reset if that does not come through: old boot loaders of the Mega leave the watchdog on,
// and are reset by it for ever before they have started anything.
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

// Returns to address 0 instead of where the program hung. All that could interrupt the start-up code is off
// before.
ISR(WDT_vect, ISR_NAKED) {
    __asm__ volatile("clr __zero_reg__ \n\t"
                     "pop r18 \n\t"
                     "pop r19 \n\t"
                     "pop r20 \n\t"
                     "push __zero_reg__ \n\t"
                     "push __zero_reg__ \n\t"
                     "push __zero_reg__ \n\t"
                     "sts %0+2, r18 \n\t"
                     "sts %0+1, r19 \n\t"
                     "sts %0, r20 \n\t"
                     :
                     : "i"(&kept.hung_at)
                     : "r18", "r19", "r20");
    kept.mark = kHung;
    TIMSK0 = TIMSK1 = TIMSK2 = TIMSK3 = TIMSK4 = TIMSK5 = 0;
    UCSR0B = UCSR1B = UCSR2B = UCSR3B = 0;
    PCICR = 0;
    wdt_disable();
    __asm__ volatile("reti");
}

namespace {

constexpr uint8_t kLookedAtPerTurn = 4;
uint8_t* looking_at = &__heap_start;
uint16_t unused = 0xFFFF;

} // namespace

bool stack_watch() {
    for (uint8_t i = 0; i < kLookedAtPerTurn; ++i) {
        if (*looking_at != kPaint) {
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
