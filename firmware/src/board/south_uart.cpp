#include "board/south_uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "board/gpio.h"
#include "core/edge_receiver.h"
#include "core/toggles.h"

namespace tilenca {
namespace board {

namespace {

// Timer 5 counts F_CPU / 8: 2 MHz / 38,400 is 52.1.
constexpr uint8_t kSouthBitCounts = 52;

static_assert(kSouthRx.port == 'K' && kSouthRx.bit == 6, "PCINT22 and the interrupt below");
static_assert(kSouthTx.port == 'K' && kSouthTx.bit == 7, "the toggles below leave from bit 7");

// GPIOR registers stand in for variables where a cycle counts: `in` and `out` take one, `lds` and `sts` two.
#define SOUTH_EDGE_HEAD GPIOR2 // where the next edge's stamp goes
#define SOUTH_BITS GPIOR0      // toggles left of the current byte, the next in bit 7
#define SOUTH_BITS_LEFT GPIOR1 // how many

// The edges' stamps: all low bytes, then all high bytes, so that one index serves both and wraps by itself.
volatile uint8_t edge_low_high[2][256];
volatile uint8_t edge_tail = 0;
volatile uint8_t edges_lost = 0; // noted by the interrupt, added up by the main loop
uint16_t overruns = 0;
EdgeReceiver receiver(kSouthBitCounts);

// The interrupt reads one byte beyond the last before it notices.
volatile uint8_t toggles[kMaxToggleBytes + 1];
volatile uint8_t toggle_at = 0;
volatile uint8_t toggle_end = 0;

// The 16-bit read goes through a register that the interrupt uses too.
uint16_t timer5_count() {
    const uint8_t interrupts = SREG;
    cli();
    const uint16_t count = TCNT5;
    SREG = interrupts;
    return count;
}

} // namespace

void south_begin() {
    set(kSouthTx, true); // an idle line is high, before it is driven
    make_output(kSouthTx);
    pull_up(kSouthRx);

    TCCR5A = 0;
    TCCR5B = 1 << CS51;
    PCMSK2 = mask_of(kSouthRx);
    PCIFR = 1 << PCIF2;
    PCICR |= 1 << PCIE2;

    // Fast PWM with ICR1 as top (mode 14), no prescaler. The mode comes first: the chip ignores writes to
    // ICR1 in a mode that does not use it as top (datasheet, "Input Capture Register").
    TCCR1B = 0;
    TCCR1A = 1 << WGM11;
    TCCR1B = 1 << WGM13 | 1 << WGM12;
    ICR1 = kSouthBitCycles - 1;
    TCNT1 = 0;
    TCCR1B |= 1 << CS10;
}

bool south_read(uint8_t* byte) {
    if (edges_lost != 0) {
        const uint8_t interrupts = SREG;
        cli();
        overruns += edges_lost;
        edges_lost = 0;
        SREG = interrupts;
    }
    // `now` before the ring: an edge that comes in between is then taken before its time, which does no harm.
    const uint16_t now = timer5_count();
    int16_t result = EdgeReceiver::kNoByte;
    while (result == EdgeReceiver::kNoByte && edge_tail != SOUTH_EDGE_HEAD) {
        const uint8_t at = edge_tail;
        const uint16_t high = edge_low_high[1][at];
        result = receiver.edge(static_cast<uint16_t>(high << 8 | edge_low_high[0][at]));
        edge_tail = at + 1;
    }
    if (result == EdgeReceiver::kNoByte) {
        result = receiver.poll(now);
    }
    *byte = static_cast<uint8_t>(result);
    return result != EdgeReceiver::kNoByte;
}

uint16_t south_overruns() {
    return overruns;
}

void south_write(const uint8_t* bytes, uint8_t size) {
    // The interrupt is off while this writes.
    toggle_end = toggles_of(bytes, size, const_cast<uint8_t*>(toggles));
    toggle_at = 1;
    SOUTH_BITS = toggles[0];
    SOUTH_BITS_LEFT = 8;
    TIFR1 = 1 << TOV1; // an old match would make the first bit short
    TIMSK1 = 1 << TOIE1;
}

bool south_idle() {
    return TIMSK1 == 0;
}

// By hand, both: every other interrupt waits for these, and what an edge is late by is lost from the half bit
// that a receiver's sampling allows. The compiler needs twice the cycles.

// First of all the line, so that every edge comes equally late; then, every eighth time, the next toggles.
ISR(TIMER1_OVF_vect, ISR_NAKED) {
    __asm__ volatile("push r24 \n\t"
                     "in r24, __SREG__ \n\t"
                     "push r24 \n\t"
                     "push r25 \n\t"
                     "in r24, %[bits] \n\t"
                     "mov r25, r24 \n\t"
                     "andi r25, 0x80 \n\t"
                     "sts %[pins], r25 \n\t"
                     "lsl r24 \n\t"
                     "out %[bits], r24 \n\t"
                     "in r24, %[left] \n\t"
                     "dec r24 \n\t"
                     "out %[left], r24 \n\t"
                     "brne 2f \n\t"
                     "push r30 \n\t"
                     "push r31 \n\t"
                     "ldi r24, 8 \n\t"
                     "out %[left], r24 \n\t"
                     "lds r30, %[at] \n\t"
                     "lds r24, %[end] \n\t"
                     "sub r24, r30 \n\t"
                     "brne 1f \n\t"
                     "sts %[mask], r24 \n\t" // all are out: no more interrupts
                     "1: mov r31, r30 \n\t"
                     "inc r31 \n\t"
                     "sts %[at], r31 \n\t"
                     "clr r31 \n\t"
                     "subi r30, lo8(-(%[toggles])) \n\t"
                     "sbci r31, hi8(-(%[toggles])) \n\t"
                     "ld r24, Z \n\t"
                     "out %[bits], r24 \n\t"
                     "pop r31 \n\t"
                     "pop r30 \n\t"
                     "2: pop r25 \n\t"
                     "pop r24 \n\t"
                     "out __SREG__, r24 \n\t"
                     "pop r24 \n\t"
                     "reti \n\t"
                     :
                     : [bits] "I"(_SFR_IO_ADDR(SOUTH_BITS)), [left] "I"(_SFR_IO_ADDR(SOUTH_BITS_LEFT)),
                       [pins] "n"(_SFR_MEM_ADDR(PINK)), [mask] "n"(_SFR_MEM_ADDR(TIMSK1)),
                       [at] "i"(&toggle_at), [end] "i"(&toggle_end), [toggles] "i"(toggles));
}

// Stores timer 5's count with the line's level in bit 0. Z points to the slot of the low byte; 256 further
// lies the high byte's.
ISR(PCINT2_vect, ISR_NAKED) {
    __asm__ volatile("push r24 \n\t"
                     "in r24, __SREG__ \n\t"
                     "push r24 \n\t"
                     "push r25 \n\t"
                     "push r30 \n\t"
                     "push r31 \n\t"
                     "lds r24, %[count] \n\t" // the low byte first: it latches the high one
                     "lds r25, %[count] + 1 \n\t"
                     "lds r30, %[pins] \n\t"
                     "andi r24, 0xFE \n\t"
                     "sbrc r30, %[rx] \n\t"
                     "ori r24, 1 \n\t"
                     "in r30, %[head] \n\t"
                     "clr r31 \n\t"
                     "subi r30, lo8(-(%[edges])) \n\t"
                     "sbci r31, hi8(-(%[edges])) \n\t"
                     "st Z, r24 \n\t" // there is always one place free
                     "inc r31 \n\t"
                     "st Z, r25 \n\t"
                     "in r30, %[head] \n\t"
                     "inc r30 \n\t"
                     "lds r24, %[tail] \n\t"
                     "cp r30, r24 \n\t"
                     "breq 1f \n\t"
                     "out %[head], r30 \n\t"
                     "2: \n\t"
                     "pop r31 \n\t"
                     "pop r30 \n\t"
                     "pop r25 \n\t"
                     "pop r24 \n\t"
                     "out __SREG__, r24 \n\t"
                     "pop r24 \n\t"
                     "reti \n\t"
                     "1: lds r24, %[lost] \n\t"
                     "inc r24 \n\t"
                     "sts %[lost], r24 \n\t"
                     "rjmp 2b \n\t"
                     :
                     : [tail] "i"(&edge_tail), [lost] "i"(&edges_lost), [count] "n"(_SFR_MEM_ADDR(TCNT5)),
                       [pins] "n"(_SFR_MEM_ADDR(PINK)), [head] "I"(_SFR_IO_ADDR(SOUTH_EDGE_HEAD)),
                       [rx] "I"(PK6), [edges] "i"(edge_low_high));
}

} // namespace board
} // namespace tilenca
