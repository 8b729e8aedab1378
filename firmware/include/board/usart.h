// The four hardware UARTs, by number. They have short interrupts of their own instead of Arduino's Serial
// objects, since an interrupt that runs while the south line changes makes that edge's time stamp late.
#pragma once

#include <stdint.h>

namespace tilenca {
namespace board {

// 8N1, both directions.
void usart_begin(uint8_t number, uint32_t baud);

// The next byte received, if any.
bool usart_read(uint8_t number, uint8_t* byte);

// Queues all of the bytes or, if there is no room for all, none.
bool usart_write(uint8_t number, const uint8_t* bytes, uint8_t size);

// How many bytes can be queued now.
uint8_t usart_room(uint8_t number);

// Whether the queue is empty. Up to two bytes may still be on their way out.
bool usart_idle(uint8_t number);

// How many bytes were lost because earlier ones were not read in time. A loss may be counted a little late.
// Stops at 65,535.
uint16_t usart_overruns(uint8_t number);

// How many bytes came without a stop bit: the line was still low. Stops at 65,535.
uint16_t usart_framing_errors(uint8_t number);

} // namespace board
} // namespace tilenca
