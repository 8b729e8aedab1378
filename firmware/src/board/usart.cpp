#include "board/usart.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stddef.h>
#include <util/atomic.h>

#include "board/gpio.h"
#include "board/ring.h"
#include "board/scratch.h"

namespace tilenca {
namespace board {

namespace {

// As they lie in data space, the same for all four (datasheet, register summary).
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

// While nothing waits to be sent.
constexpr uint8_t kQuiet = 1 << TXEN0 | 1 << RXEN0 | 1 << RXCIE0;

// A link's byte takes 260 us and the main loop comes by every two milliseconds at the latest; a frame to send
// is at most 60 bytes. USART n has quarter n of a page. What goes to the host has a page of its own: a whole
// round of sentences.
using QuarterRing = Ring<64>;
using HostRing = Ring<256>;
TILENCA_PAGE Page received_page;
TILENCA_PAGE Page sending_page;
TILENCA_PAGE Page host_page;
QuarterRing received[4];
QuarterRing sending[4];
HostRing host_sending;
volatile uint16_t overruns[4];

constexpr uint8_t first_of(uint8_t number) {
    return static_cast<uint8_t>(number * 64);
}

} // namespace

void usart_begin(uint8_t number, uint32_t baud) {
    scratch_begin();
    received[number].begin(first_of(number));
    sending[number].begin(first_of(number));
    Registers& usart = registers_of(number);
    usart.control_a = 1 << U2X0;
    usart.baud = static_cast<uint16_t>((F_CPU / 4 / baud - 1) / 2); // F_CPU / 8 / baud - 1, rounded
    usart.control_c = 1 << UCSZ01 | 1 << UCSZ00;
    usart.control_b = kQuiet;
}

bool usart_read(uint8_t number, uint8_t* byte) {
    if (received[number].empty()) {
        return false;
    }
    *byte = received[number].take(received_page);
    return true;
}

uint16_t usart_overruns(uint8_t number) {
    uint16_t count;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        count = overruns[number];
    }
    return count;
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
    const bool queued = number == kHostUsart ? queue_all(host_sending, host_page, bytes, size)
                                             : queue_all(sending[number], sending_page, bytes, size);
    if (queued) {
        // The interrupt for "data register empty" turns itself off when the queue runs dry.
        registers_of(number).control_b = kQuiet | 1 << UDRIE0;
    }
    return queued;
}

uint8_t usart_room(uint8_t number) {
    return number == kHostUsart ? host_sending.room() : sending[number].room();
}

bool usart_idle(uint8_t number) {
    return number == kHostUsart ? host_sending.empty() : sending[number].empty();
}

// By hand, in half the compiler's cycles and without a flag touched: while one of these runs, an edge of the
// south link waits for its time stamp. They do what put() and take() do, with Z as the pointer and r24 for
// the byte.
// clang-format off
#define ENTER "out %[r24], r24 \n\t out %[r30], r30 \n\t out %[r31], r31 \n\t"
#define LEAVE "in r31, %[r31] \n\t in r30, %[r30] \n\t in r24, %[r24] \n\t reti \n\t"
// After Z+ has gone beyond a quarter, back to its first byte. `skip`: bit 6 tells even quarters from odd ones.
#define WRAP(skip) skip " r30, 6 \n\t ldi r30, %[first] \n\t"
#define NO_WRAP ""
#define PLACES \
    [r24] "I"(_SFR_IO_ADDR(SCRATCH_R24)), [r30] "I"(_SFR_IO_ADDR(SCRATCH_R30)), \
    [r31] "I"(_SFR_IO_ADDR(SCRATCH_R31)), [first] "n"(int{first_of(kNumber)})

#define RECEIVE(skip) \
    __asm__ volatile( \
        ENTER \
        "lds r31, %[status] \n\t" \
        "lds r24, %[data] \n\t" \
        "sbrc r31, %[overrun] \n\t" \
        "rjmp 3f \n\t" \
        "1: ldi r31, hi8(%[page]) \n\t" \
        "lds r30, %[head] \n\t" \
        "st Z+, r24 \n\t" /* if there is no room, nobody will know */ \
        WRAP(skip) \
        "lds r24, %[tail] \n\t" \
        "cpse r30, r24 \n\t" \
        "rjmp 2f \n\t" \
        "rcall 4f \n\t" \
        LEAVE \
        "2: sts %[head], r30 \n\t" \
        LEAVE \
        "3: rcall 4f \n\t" /* the USART itself lost a byte before this one */ \
        "rjmp 1b \n\t" \
        "4: push r24 \n\t" \
        "in r24, __SREG__ \n\t" \
        "push r24 \n\t" \
        "lds r30, %[lost] \n\t" \
        "lds r31, %[lost] + 1 \n\t" \
        "adiw r30, 1 \n\t" \
        "breq 5f \n\t" \
        "sts %[lost] + 1, r31 \n\t" \
        "sts %[lost], r30 \n\t" \
        "5: pop r24 \n\t" \
        "out __SREG__, r24 \n\t" \
        "pop r24 \n\t" \
        "ret \n\t" \
        : \
        : PLACES, \
          [status] "n"(kRegisters[kNumber] + offsetof(Registers, control_a)), [overrun] "I"(DOR0), \
          [data] "n"(kRegisters[kNumber] + offsetof(Registers, data)), \
          [head] "i"(&received[kNumber].head), [tail] "i"(&received[kNumber].tail), \
          [page] "i"(received_page.bytes), [lost] "i"(&overruns[kNumber]))

#define SEND(queue, bytes_page, wrap) \
    __asm__ volatile( \
        ENTER \
        "lds r30, %[tail] \n\t" \
        "lds r24, %[head] \n\t" \
        "cpse r30, r24 \n\t" \
        "rjmp 1f \n\t" \
        "ldi r24, %[quiet] \n\t" /* nothing left: no more interrupts */ \
        "sts %[control], r24 \n\t" \
        LEAVE \
        "1: ldi r31, hi8(%[page]) \n\t" \
        "ld r24, Z+ \n\t" \
        "sts %[data], r24 \n\t" \
        wrap \
        "sts %[tail], r30 \n\t" \
        LEAVE \
        : \
        : PLACES, \
          [control] "n"(kRegisters[kNumber] + offsetof(Registers, control_b)), [quiet] "n"(int{kQuiet}), \
          [data] "n"(kRegisters[kNumber] + offsetof(Registers, data)), \
          [head] "i"(&queue.head), [tail] "i"(&queue.tail), [page] "i"(bytes_page.bytes))
// clang-format on

template <uint8_t kNumber>
inline __attribute__((always_inline)) void receive() {
    if (kNumber % 2 == 0) {
        RECEIVE("sbrc");
    } else {
        RECEIVE("sbrs");
    }
}

template <uint8_t kNumber>
inline __attribute__((always_inline)) void send() {
    if (kNumber == kHostUsart) {
        SEND(host_sending, host_page, NO_WRAP);
    } else if (kNumber % 2 == 0) {
        SEND(sending[kNumber], sending_page, WRAP("sbrc"));
    } else {
        SEND(sending[kNumber], sending_page, WRAP("sbrs"));
    }
}

#undef ENTER
#undef LEAVE
#undef WRAP
#undef NO_WRAP
#undef PLACES
#undef RECEIVE
#undef SEND

ISR(USART0_RX_vect, ISR_NAKED) {
    receive<0>();
}
ISR(USART1_RX_vect, ISR_NAKED) {
    receive<1>();
}
ISR(USART2_RX_vect, ISR_NAKED) {
    receive<2>();
}
ISR(USART3_RX_vect, ISR_NAKED) {
    receive<3>();
}

ISR(USART0_UDRE_vect, ISR_NAKED) {
    send<0>();
}
ISR(USART1_UDRE_vect, ISR_NAKED) {
    send<1>();
}
ISR(USART2_UDRE_vect, ISR_NAKED) {
    send<2>();
}
ISR(USART3_UDRE_vect, ISR_NAKED) {
    send<3>();
}

} // namespace board
} // namespace tilenca
