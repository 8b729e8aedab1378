#include "board/south_uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "board/chip.h"
#include "board/gpio.h"
#include "board/ring.h"
#include "board/scratch.h"
#include "core/edge_receiver.h"
#include "core/toggles.h"

namespace tilenca {
namespace board {

namespace {

// Timer 5 counts F_CPU / 8: 2 MHz / 38,400 is 52.1.
constexpr uint8_t kSouthBitCounts = 52;

// A UART's edges are a bit apart at least. What comes this much faster on average, but for a few, is noise.
constexpr uint8_t kFastestCounts = 45;
constexpr uint16_t kFewEdgesCounts = 24 * kFastestCounts;
// How long noise makes deaf: 20 ms. To fill the ring takes the interrupt less than one.
constexpr uint16_t kRestCounts = 40000;

static_assert(kSouthRx.port == 'K' && kSouthRx.bit == 6, "PCINT22 and the interrupt below");
static_assert(kSouthTx.port == 'K' && kSouthTx.bit == 7, "the toggles below leave from bit 7");

// A ring of edges. Its head is SOUTH_EDGE_HEAD, its tail SOUTH_EDGE_TAIL. That of an edge is the place of its
// count's low byte and of port K's levels; the count's high byte lies one further.
TILENCA_PAGE Page edge_lows;
TILENCA_PAGE Page edge_highs;
TILENCA_PAGE Page edge_levels;
using Receiver = EdgeReceiver<kSouthBitCounts>;
Receiver receiver;
uint16_t looked_at = 0;  // when the ring was last looked at
uint8_t looked_head = 0; // and its head then
uint16_t haste = 0;      // by how many counts the edges are ahead of what a UART can do
uint16_t rests_since = 0;
uint16_t overruns = 0;

// What is being sent: SOUTH_TOGGLES is shifted out, these follow. The alignment keeps them in one page.
TILENCA_PAGE volatile uint8_t toggles[kMaxToggleBytes] __attribute__((aligned(128)));
static_assert(kMaxToggleBytes <= 128, "one index reaches all of them");
volatile uint8_t toggles_at = 0; // the low byte of the next one's address

bool listening() {
    return PCICR & 1 << PCIE2;
}

void listen(uint16_t now) {
    SOUTH_EDGE_HEAD = 0;
    SOUTH_EDGE_TAIL = 0;
    receiver.reset();
    looked_at = now;
    looked_head = 0;
    haste = 0;
    PCIFR = 1 << PCIF2;
    PCICR = 1 << PCIE2;
}

// Gives up what waits in the ring. Too many edges for the time they took are noise, which would soon fill it
// again; otherwise the main loop was late.
void lose_edges(uint16_t now, bool noise) {
    overruns += overruns != UINT16_MAX;
    if (!noise) {
        listen(now);
        return;
    }
    PCICR = 0;
    SOUTH_EDGE_TAIL = SOUTH_EDGE_HEAD;
    rests_since = now;
}

uint8_t edges_waiting() {
    return static_cast<uint8_t>(SOUTH_EDGE_HEAD - SOUTH_EDGE_TAIL);
}

// Whether edges come faster than a UART's.
bool is_noise(uint16_t now) {
    const uint8_t head = SOUTH_EDGE_HEAD;
    haste += static_cast<uint8_t>(head - looked_head) * kFastestCounts;
    const uint16_t passed = now - looked_at;
    haste = haste > passed ? haste - passed : 0;
    looked_head = head;
    looked_at = now;
    return haste > kFewEdgesCounts;
}

// As the interrupt stores it, with the level in bit 0: by hand, since the compiler takes thrice the cycles.
inline __attribute__((always_inline)) bool take_edge(uint16_t* stamp) {
    uint8_t low, high;
    uint16_t at = SOUTH_EDGE_TAIL; // the low byte of an address; which page, is put above it
    if (static_cast<uint8_t>(at) == SOUTH_EDGE_HEAD) {
        return false;
    }
    __asm__ volatile("ldi r31, hi8(%[lows]) \n\t"
                     "ld %[low], Z \n\t"
                     "ldi r31, hi8(%[levels]) \n\t"
                     "ld %[high], Z+ \n\t"
                     "bst %[high], %[rx] \n\t"
                     "bld %[low], 0 \n\t"
                     "ldi r31, hi8(%[highs]) \n\t"
                     "ld %[high], Z \n\t"
                     : [low] "=&r"(low), [high] "=&r"(high), "+z"(at)
                     : [rx] "I"(PK6), [lows] "i"(edge_lows.bytes), [highs] "i"(edge_highs.bytes),
                       [levels] "i"(edge_levels.bytes)
                     : "memory");
    SOUTH_EDGE_TAIL = static_cast<uint8_t>(at);
    *stamp = static_cast<uint16_t>(static_cast<uint16_t>(high) << 8 | low);
    return true;
}

} // namespace

void south_begin() {
    scratch_begin();
    set(kSouthTx, true); // an idle line is high, before it is driven
    make_output(kSouthTx);
    pull_up(kSouthRx);

    TCCR5A = 0;
    TCCR5B = 1 << CS51;
    PCMSK2 = mask_of(kSouthRx);
    listen(stamp());

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
    // `now` before the ring: an edge that comes in between is then taken before its time, which does no harm.
    const uint16_t now = stamp();
    if (!listening() && edges_waiting() == 0) {
        if (static_cast<uint16_t>(now - rests_since) >= kRestCounts) {
            listen(now);
        }
        return false;
    }
    const bool noise = is_noise(now);
    if (noise || !listening()) { // or the interrupt found no room and turned itself off
        lose_edges(now, noise);
        return false;
    }
    const int16_t result = receiver.receive([](uint16_t* stamp) { return take_edge(stamp); }, now);
    *byte = static_cast<uint8_t>(result);
    return result != Receiver::kNoByte;
}

void south_write(const uint8_t* bytes, uint8_t size) {
    // The interrupt is off while this writes.
    toggles_of(bytes, size, const_cast<uint8_t*>(toggles));
    SOUTH_TOGGLES = toggles[0];
    toggles_at = static_cast<uint8_t>(reinterpret_cast<uintptr_t>(&toggles[1]));
    TIFR1 = 1 << TOV1; // an old match would make the first bit short
    TIMSK1 = 1 << TOIE1;
}

bool south_idle() {
    return TIMSK1 == 0;
}

uint16_t south_overruns() {
    return overruns;
}

// By hand, both: every other interrupt waits for these, and what an edge is late by is lost from the half bit
// that a receiver's sampling allows. The compiler needs twice the cycles.

// First of all the line, so that every edge comes equally late; then, every seventh time, the next toggles.
ISR(TIMER1_OVF_vect, ISR_NAKED) {
    __asm__ volatile("out %[r24], r24 \n\t"
                     "in r24, __SREG__ \n\t"
                     "out %[flags], r24 \n\t"
                     "in r24, %[bits] \n\t"
                     "lsl r24 \n\t"
                     "out %[bits], r24 \n\t"
                     "brcc 1f \n\t"
                     "ldi r24, 0x80 \n\t"
                     "sts %[pins], r24 \n\t"
                     "in r24, %[bits] \n\t"
                     "1: cpi r24, %[end] \n\t"
                     "brne 3f \n\t"
                     "push r30 \n\t"
                     "push r31 \n\t"
                     "lds r30, %[at] \n\t"
                     "ldi r31, hi8(%[toggles]) \n\t"
                     "ld r24, Z+ \n\t"
                     "sts %[at], r30 \n\t"
                     "pop r31 \n\t"
                     "pop r30 \n\t"
                     "out %[bits], r24 \n\t"
                     "cpi r24, %[end] \n\t"
                     "brne 3f \n\t"
                     "ldi r24, 0 \n\t"
                     "sts %[mask], r24 \n\t" // all are out: no more interrupts
                     "3: in r24, %[flags] \n\t"
                     "out __SREG__, r24 \n\t"
                     "in r24, %[r24] \n\t"
                     "reti \n\t"
                     :
                     : [r24] "I"(_SFR_IO_ADDR(SCRATCH_R24)), [flags] "I"(_SFR_IO_ADDR(SCRATCH_R30)),
                       [bits] "I"(_SFR_IO_ADDR(SOUTH_TOGGLES)), [end] "n"(int{kNoMoreToggles}),
                       [pins] "n"(_SFR_MEM_ADDR(PINK)), [mask] "n"(_SFR_MEM_ADDR(TIMSK1)),
                       [at] "i"(&toggles_at), [toggles] "i"(toggles));
}

// Stores timer 5's count and port K's levels. Not a flag is touched: none has to be saved.
ISR(PCINT2_vect, ISR_NAKED) {
    __asm__ volatile(
        "out %[r24], r24 \n\t"
        "out %[r30], r30 \n\t"
        "out %[r31], r31 \n\t"
        "lds r24, %[count] \n\t" // the low byte first: it latches the high one
        "in r30, %[head] \n\t"
        "ldi r31, hi8(%[lows]) \n\t"
        "st Z, r24 \n\t"
        "lds r24, %[pins] \n\t"
        "ldi r31, hi8(%[levels]) \n\t"
        "st Z+, r24 \n\t"
        "lds r24, %[count] + 1 \n\t"
        "ldi r31, hi8(%[highs]) \n\t"
        "st Z, r24 \n\t"
        "in r24, %[tail] \n\t"
        "cpse r30, r24 \n\t"
        "rjmp 1f \n\t"
        "ldi r24, 0 \n\t"
        "sts %[control], r24 \n\t" // no room: no more interrupts
        "rjmp 2f \n\t"
        "1: out %[head], r30 \n\t"
        "2: in r31, %[r31] \n\t"
        "in r30, %[r30] \n\t"
        "in r24, %[r24] \n\t"
        "reti \n\t"
        :
        : [r24] "I"(_SFR_IO_ADDR(SCRATCH_R24)), [r30] "I"(_SFR_IO_ADDR(SCRATCH_R30)),
          [r31] "I"(_SFR_IO_ADDR(SCRATCH_R31)), [count] "n"(_SFR_MEM_ADDR(TCNT5)),
          [pins] "n"(_SFR_MEM_ADDR(PINK)), [control] "n"(_SFR_MEM_ADDR(PCICR)),
          [head] "I"(_SFR_IO_ADDR(SOUTH_EDGE_HEAD)), [tail] "I"(_SFR_IO_ADDR(SOUTH_EDGE_TAIL)),
          [lows] "i"(edge_lows.bytes), [highs] "i"(edge_highs.bytes), [levels] "i"(edge_levels.bytes));
}

} // namespace board
} // namespace tilenca
