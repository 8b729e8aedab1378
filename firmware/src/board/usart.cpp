#include "board/usart.h"

#include <avr/io.h>
#include <stddef.h>
#include <util/atomic.h>

#include "board/gpio.h"
#include "board/ring.h"
#include "board/scratch.h"
#include "board/usart_layout.h"
#include "core/frame.h"

namespace tilenca {
namespace board {

using QuarterRing = Ring<QUARTER_BYTES>;
using HostRing = Ring<256>;

// The queues that the interrupts in avr/usart.S work on. A byte takes 260 us between north and south and 80
// us between east and west, so a quarter holds at least 5 ms of them (links.cpp). What goes to the host
// has a page of its own, since a sentence may have 200 bytes.
extern "C" {
TILENCA_PAGE Page tilenca_received_page;
TILENCA_PAGE Page tilenca_sending_page;
TILENCA_PAGE Page tilenca_host_page;
QuarterRing tilenca_received[4];
QuarterRing tilenca_sending[4];
HostRing tilenca_host_sending;
volatile uint16_t tilenca_usart_overruns[4];
volatile uint16_t tilenca_usart_framing_errors[4];
}

namespace {

// The order in data space, the same for all four (datasheet, register summary).
struct Registers {
    volatile uint8_t control_a;
    volatile uint8_t control_b;
    volatile uint8_t control_c;
    volatile uint8_t reserved;
    volatile uint16_t baud;
    volatile uint8_t data;
};

constexpr uint16_t kRegisters[4] = {0xC0, 0xC8, 0xD0, 0x130};

Registers& registers_of(uint8_t number) {
    return *reinterpret_cast<Registers*>(kRegisters[number]);
}

static_assert(offsetof(QuarterRing, head) == RING_HEAD && offsetof(QuarterRing, tail) == RING_TAIL &&
                  sizeof(QuarterRing) == RING_BYTES,
              "avr/usart.S");
static_assert(offsetof(HostRing, head) == RING_HEAD && offsetof(HostRing, tail) == RING_TAIL, "avr/usart.S");
static_assert(4 * QUARTER_BYTES == sizeof(Page), "QUARTER_BIT changes from one quarter to the next");
static_assert(offsetof(Registers, control_b) == USART_CONTROL && offsetof(Registers, data) == USART_DATA,
              "avr/usart.S");
static_assert(kHostUsart == 0, "avr/usart.S");
static_assert(kMaxFrame < QUARTER_BYTES, "a frame that is to be sent has room");

} // namespace

void usart_begin(uint8_t number, uint32_t baud) {
    scratch_begin();
    tilenca_received[number].begin(QUARTER_START(number));
    tilenca_sending[number].begin(QUARTER_START(number));
    Registers& usart = registers_of(number);
    // Sixteen samples for a bit bear more than eight. Where they would make the rate less right, eight do.
    const uint16_t eighths = static_cast<uint16_t>((F_CPU / 4 / baud + 1) / 2); // F_CPU / 8 / baud, rounded
    const bool by_eight = eighths & 1;
    usart.control_a = by_eight ? 1 << U2X0 : 0;
    usart.baud = by_eight ? eighths - 1 : eighths / 2 - 1;
    usart.control_c = 1 << UCSZ01 | 1 << UCSZ00;
    usart.control_b = USART_QUIET;
}

bool usart_read(uint8_t number, uint8_t* byte) {
    if (tilenca_received[number].empty()) {
        return false;
    }
    *byte = tilenca_received[number].take(tilenca_received_page);
    return true;
}

namespace {

uint16_t read_whole(const volatile uint16_t& counter) {
    uint16_t count;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        count = counter;
    }
    return count;
}

} // namespace

uint16_t usart_overruns(uint8_t number) {
    return read_whole(tilenca_usart_overruns[number]);
}

uint16_t usart_framing_errors(uint8_t number) {
    return read_whole(tilenca_usart_framing_errors[number]);
}

namespace {

template <typename Queue>
bool queue_all(Queue& queue, Page& page, const uint8_t* bytes, uint8_t size) {
    if (queue.room() < size) {
        return false;
    }
    for (uint8_t i = 0; i < size; ++i) {
        queue.put(page, bytes[i]);
    }
    return true;
}

} // namespace

bool usart_write(uint8_t number, const uint8_t* bytes, uint8_t size) {
    const bool queued = number == kHostUsart
                            ? queue_all(tilenca_host_sending, tilenca_host_page, bytes, size)
                            : queue_all(tilenca_sending[number], tilenca_sending_page, bytes, size);
    if (queued) {
        // The interrupt for "data register empty" turns itself off when the queue runs dry.
        registers_of(number).control_b = USART_QUIET | 1 << UDRIE0;
    }
    return queued;
}

uint8_t usart_room(uint8_t number) {
    return number == kHostUsart ? tilenca_host_sending.room() : tilenca_sending[number].room();
}

bool usart_idle(uint8_t number) {
    return number == kHostUsart ? tilenca_host_sending.empty() : tilenca_sending[number].empty();
}

} // namespace board
} // namespace tilenca
