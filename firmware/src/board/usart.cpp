#include "board/usart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

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

Registers& registers_of(uint8_t number) { return *reinterpret_cast<Registers*>(kRegisters[number]); }

// A link's byte takes 260 us and the main loop comes by every two milliseconds at the latest; a frame to send is
// at most 59 bytes. The host's ring holds a whole round of sentences.
Ring<64> received[4];
Ring<64> link_queues[4];
Ring<256> host_queue;

} // namespace

void usart_begin(uint8_t number, uint32_t baud) {
    Registers& usart = registers_of(number);
    usart.control_a = 1 << U2X0;
    usart.baud = static_cast<uint16_t>((F_CPU / 4 / baud - 1) / 2); // F_CPU / 8 / baud - 1, rounded
    usart.control_c = 1 << UCSZ01 | 1 << UCSZ00;
    usart.control_b = number == kHostUsart ? 1 << TXEN0 : 1 << TXEN0 | 1 << RXEN0 | 1 << RXCIE0;
}

bool usart_read(uint8_t number, uint8_t* byte) {
    if (received[number].empty()) {
        return false;
    }
    *byte = received[number].take();
    return true;
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

template <typename Queue>
inline void send_next(Queue& queue, volatile uint8_t& data, volatile uint8_t& control_b) {
    if (queue.empty()) {
        control_b &= ~(1 << UDRIE0);
    } else {
        data = queue.take();
    }
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

bool usart_idle(uint8_t number) {
    return number == kHostUsart ? host_queue.empty() : link_queues[number].empty();
}

ISR(USART1_RX_vect) { received[1].put(UDR1); }
ISR(USART2_RX_vect) { received[2].put(UDR2); }
ISR(USART3_RX_vect) { received[3].put(UDR3); }

ISR(USART0_UDRE_vect) { send_next(host_queue, UDR0, UCSR0B); }
ISR(USART1_UDRE_vect) { send_next(link_queues[1], UDR1, UCSR1B); }
ISR(USART2_UDRE_vect) { send_next(link_queues[2], UDR2, UCSR2B); }
ISR(USART3_UDRE_vect) { send_next(link_queues[3], UDR3, UCSR3B); }

} // namespace board
} // namespace tilenca
