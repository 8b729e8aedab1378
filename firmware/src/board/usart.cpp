#include "board/usart.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stddef.h>

#include "board/gpio.h"
#include "board/ring.h"

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

// A link's byte takes 260 us and the main loop comes by every two milliseconds at the latest; a frame to send
// is at most 59 bytes. The host's ring holds a whole round of sentences.
using LinkRing = Ring<64>;
using HostRing = Ring<256>;
LinkRing received[4];
LinkRing link_queues[4];
HostRing host_queue;

// Noted by the interrupts, added up by the main loop.
volatile uint8_t overrun[4];
uint16_t overruns[4];

} // namespace

void usart_begin(uint8_t number, uint32_t baud) {
    Registers& usart = registers_of(number);
    usart.control_a = 1 << U2X0;
    usart.baud = static_cast<uint16_t>((F_CPU / 4 / baud - 1) / 2); // F_CPU / 8 / baud - 1, rounded
    usart.control_c = 1 << UCSZ01 | 1 << UCSZ00;
    usart.control_b = 1 << TXEN0 | 1 << RXEN0 | 1 << RXCIE0;
}

bool usart_read(uint8_t number, uint8_t* byte) {
    if (overrun[number] != 0) {
        const uint8_t interrupts = SREG;
        cli();
        overruns[number] += overrun[number];
        overrun[number] = 0;
        SREG = interrupts;
    }
    if (received[number].empty()) {
        return false;
    }
    *byte = received[number].take();
    return true;
}

uint16_t usart_overruns(uint8_t number) {
    return overruns[number];
}

namespace {

template <typename Queue>
bool queue_all(Queue& queue, const uint8_t* bytes, uint8_t size) {
    if (queue.room() < size) {
        return false;
    }
    for (uint8_t i = 0; i < size; ++i) {
        queue.put(bytes[i]);
    }
    return true;
}

// The interrupt for "data register empty" turns itself off when the queue runs dry; the atomic bit set that
// would not race with it does not exist for these addresses.
void start_sending(uint8_t number) {
    const uint8_t interrupts = SREG;
    cli();
    registers_of(number).control_b |= 1 << UDRIE0;
    SREG = interrupts;
}

} // namespace

bool usart_write(uint8_t number, const uint8_t* bytes, uint8_t size) {
    const bool queued = number == kHostUsart ? queue_all(host_queue, bytes, size)
                                             : queue_all(link_queues[number], bytes, size);
    if (queued) {
        start_sending(number);
    }
    return queued;
}

uint8_t usart_room(uint8_t number) {
    return number == kHostUsart ? host_queue.room() : link_queues[number].room();
}

bool usart_idle(uint8_t number) {
    return number == kHostUsart ? host_queue.empty() : link_queues[number].empty();
}

// By hand, in half the compiler's cycles: while one of these runs, an edge of the south link waits for its
// time stamp. They do what put() and take() do, with Z as the pointer and r24 for the byte.
// clang-format off
#define ENTER \
    "push r24 \n\t in r24, __SREG__ \n\t push r24 \n\t" \
    "push r30 \n\t push r31 \n\t"
#define LEAVE \
    "pop r31 \n\t pop r30 \n\t" \
    "pop r24 \n\t out __SREG__, r24 \n\t pop r24 \n\t reti \n\t"
// Moves the index in r30 on in memory, and points Z to the byte that it stood for.
#define MOVE_ON(index) \
    "mov r31, r30 \n\t inc r31 \n\t andi r31, %[wrap] \n\t sts " index ", r31 \n\t" \
    "clr r31 \n\t subi r30, lo8(-(%[bytes])) \n\t sbci r31, hi8(-(%[bytes])) \n\t"

template <uint8_t kNumber>
inline __attribute__((always_inline)) void receive() {
    __asm__ volatile(
        ENTER
        "lds r24, %[status] \n\t" // before the byte, with which it goes
        "bst r24, %[lost] \n\t"
        "lds r24, %[data] \n\t"
        "lds r30, %[head] \n\t"
        "clr r31 \n\t"
        "subi r30, lo8(-(%[bytes])) \n\t"
        "sbci r31, hi8(-(%[bytes])) \n\t"
        "st Z, r24 \n\t" // there is always one place free
        "lds r30, %[head] \n\t"
        "inc r30 \n\t"
        "andi r30, %[wrap] \n\t"
        "lds r24, %[tail] \n\t"
        "cp r30, r24 \n\t"
        "breq 1f \n\t"
        "sts %[head], r30 \n\t"
        "brts 1f \n\t"
        "rjmp 2f \n\t"
        "1: lds r24, %[overrun] \n\t"
        "inc r24 \n\t"
        "sts %[overrun], r24 \n\t"
        "2: \n\t"
        LEAVE
        :
        : [status] "n"(kRegisters[kNumber] + offsetof(Registers, control_a)), [lost] "n"(DOR0),
          [data] "n"(kRegisters[kNumber] + offsetof(Registers, data)),
          [tail] "i"(&received[kNumber].tail), [overrun] "i"(&overrun[kNumber]),
          [head] "i"(&received[kNumber].head),
          [bytes] "i"(received[kNumber].bytes),
          [wrap] "n"(int{LinkRing::kWrap}));
}

template <uint8_t kNumber>
inline __attribute__((always_inline)) void send() {
    constexpr bool kHost = kNumber == kHostUsart;
    __asm__ volatile(
        ENTER
        "lds r30, %[tail] \n\t"
        "lds r24, %[head] \n\t"
        "cp r30, r24 \n\t"
        "breq 1f \n\t"
        MOVE_ON("%[tail]")
        "ld r24, Z \n\t"
        "sts %[data], r24 \n\t"
        "rjmp 2f \n\t"
        "1: lds r24, %[control] \n\t" // nothing left: no more interrupts
        "andi r24, %[off] \n\t"
        "sts %[control], r24 \n\t"
        "2: \n\t"
        LEAVE
        :
        : [data] "n"(kRegisters[kNumber] + offsetof(Registers, data)),
          [control] "n"(kRegisters[kNumber] + offsetof(Registers, control_b)),
          [off] "n"(0xFF & ~(1 << UDRIE0)),
          [head] "i"(kHost ? &host_queue.head : &link_queues[kNumber].head),
          [tail] "i"(kHost ? &host_queue.tail : &link_queues[kNumber].tail),
          [bytes] "i"(kHost ? host_queue.bytes : link_queues[kNumber].bytes),
          [wrap] "n"(int{kHost ? HostRing::kWrap : LinkRing::kWrap}));
}
// clang-format on

#undef ENTER
#undef LEAVE
#undef MOVE_ON

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
