#include "board/south_uart.h"

#include <avr/io.h>

#include "board/chip.h"
#include "board/gpio.h"
#include "board/ring.h"
#include "board/scratch.h"
#include "board/south_layout.h"
#include "core/edge_receiver.h"
#include "core/toggles.h"

namespace tilenca {
namespace board {

constexpr uint8_t kToggleBytes = 128;

// What the interrupts in avr/south_uart.S work on.
extern "C" {
// The ring of edges; south_layout.h says what lies where.
TILENCA_PAGE Page tilenca_edge_lows;
TILENCA_PAGE Page tilenca_edge_highs;
TILENCA_PAGE Page tilenca_edge_levels;

// The toggles that follow those in SOUTH_TOGGLES. The alignment keeps them in one page.
TILENCA_PAGE volatile uint8_t tilenca_toggles[kMaxToggleBytes] __attribute__((aligned(kToggleBytes)));
volatile uint8_t tilenca_toggles_at = 0; // the low byte of the next one's address
}

namespace {

// Timer 5 counts F_CPU / 8: 2 MHz / 38,400 is 52.1.
constexpr uint8_t kSouthBitCounts = 52;

// A UART's edges are at least a bit apart. Edges that are closer than this on average are noise; a burst of
// 24 is tolerated.
constexpr uint8_t kFastestCounts = 45;
constexpr uint16_t kAllowedExcessCounts = 24 * kFastestCounts;
// 20 ms. The interrupt takes less than 1 ms to fill the ring.
constexpr uint16_t kHoldoffCounts = 40000;

static_assert(kSouthRx.port == 'K' && kSouthRx.bit == 6, "PCINT22; the interrupt stores port K");
static_assert(kSouthTx.port == 'K' && mask_of(kSouthTx) == SOUTH_TX_MASK, "avr/south_uart.S");

using Receiver = EdgeReceiver<kSouthBitCounts>;
Receiver receiver;
uint16_t looked_at = 0;   // when south_read() last looked at the ring
uint8_t looked_head = 0;  // the ring's head at that time
uint16_t edge_excess = 0; // excess edge rate: by how many counts the edges are ahead of the fastest UART's
uint16_t holdoff_since = 0;
uint16_t overruns = 0;

static_assert(kMaxToggleBytes <= kToggleBytes, "one index reaches all of them");
static_assert(kNoMoreToggles == SOUTH_NO_TOGGLES, "avr/south_uart.S");

bool listening() {
    return PCICR & 1 << PCIE2;
}

void listen(uint16_t now) {
    SOUTH_EDGE_HEAD = 0;
    SOUTH_EDGE_TAIL = 0;
    receiver.reset();
    looked_at = now;
    looked_head = 0;
    edge_excess = 0;
    PCIFR = 1 << PCIF2;
    PCICR = 1 << PCIE2;
}

// Drops the edges in the ring. Noise would soon fill it again, so a holdoff follows; otherwise the main loop
// was late.
void lose_edges(uint16_t now, bool noise) {
    overruns += overruns != UINT16_MAX;
    if (!noise) {
        listen(now);
        return;
    }
    PCICR = 0;
    SOUTH_EDGE_TAIL = SOUTH_EDGE_HEAD;
    holdoff_since = now;
}

uint8_t edges_waiting() {
    return static_cast<uint8_t>(SOUTH_EDGE_HEAD - SOUTH_EDGE_TAIL);
}

// Whether edges have come faster than a UART's.
bool is_noise(uint16_t now) {
    const uint8_t head = SOUTH_EDGE_HEAD;
    edge_excess += static_cast<uint8_t>(head - looked_head) * kFastestCounts;
    const uint16_t passed = now - looked_at;
    edge_excess = edge_excess > passed ? edge_excess - passed : 0;
    looked_head = head;
    looked_at = now;
    return edge_excess > kAllowedExcessCounts;
}

// Takes an edge that the interrupt has stored, and puts its level into bit 0. By hand, since the compiler
// needs three times the cycles.
inline __attribute__((always_inline)) bool take_edge(uint16_t* stamp) {
    uint8_t low, high;
    uint16_t at = SOUTH_EDGE_TAIL; // the low byte of an address; the high byte is the page's
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
                     : [rx] "I"(PK6), [lows] "i"(tilenca_edge_lows.bytes),
                       [highs] "i"(tilenca_edge_highs.bytes), [levels] "i"(tilenca_edge_levels.bytes)
                     : "memory");
    SOUTH_EDGE_TAIL = static_cast<uint8_t>(at);
    *stamp = static_cast<uint16_t>(static_cast<uint16_t>(high) << 8 | low);
    return true;
}

} // namespace

void south_begin() {
    scratch_begin();
    set(kSouthTx, true); // high, as an idle line is, before the pin drives it
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
    // `now` is read before the ring. An edge in between is taken a little early, which does no harm.
    const uint16_t now = stamp();
    if (!listening() && edges_waiting() == 0) {
        if (static_cast<uint16_t>(now - holdoff_since) >= kHoldoffCounts) {
            listen(now);
        }
        return false;
    }
    const bool noise = is_noise(now);
    if (noise || !listening()) { // the interrupt turns itself off when it finds no room
        lose_edges(now, noise);
        return false;
    }
    const int16_t result = receiver.receive([](uint16_t* stamp) { return take_edge(stamp); }, now);
    *byte = static_cast<uint8_t>(result);
    return result != Receiver::kNoByte;
}

void south_write(const uint8_t* bytes, uint8_t size) {
    // The interrupt is off while this writes.
    toggles_of(bytes, size, const_cast<uint8_t*>(tilenca_toggles));
    SOUTH_TOGGLES = tilenca_toggles[0];
    tilenca_toggles_at = static_cast<uint8_t>(reinterpret_cast<uintptr_t>(&tilenca_toggles[1]));
    TIFR1 = 1 << TOV1; // an old overflow would make the first bit too short
    TIMSK1 = 1 << TOIE1;
}

bool south_idle() {
    return TIMSK1 == 0;
}

uint16_t south_overruns() {
    return overruns;
}

uint16_t south_framing_errors() {
    return receiver.framing_errors();
}

} // namespace board
} // namespace tilenca
