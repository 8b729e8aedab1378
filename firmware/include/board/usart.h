// The four hardware UARTs, by number. Short interrupts of our own instead of Arduino's Serial objects:
// whatever runs while the south link's line changes makes that edge's time stamp late.
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

// Whether nothing is queued; up to two bytes may still be leaving.
bool usart_idle(uint8_t number);

// How many bytes were lost because those before them were not read in time; said a little late. Stops at
// 65,535.
uint16_t usart_overruns(uint8_t number);

} // namespace board
} // namespace tilenca
