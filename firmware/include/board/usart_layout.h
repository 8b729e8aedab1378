// What usart.cpp shares with its interrupts in avr/usart.S. Read by the assembler too, so only macros.
#pragma once

#include <avr/io.h>

// The members of a Ring, whatever its size.
#define RING_HEAD 0
#define RING_TAIL 1
#define RING_BYTES 2

// USART n has quarter n of a page. This bit of an index changes from one quarter to the next.
#define QUARTER_BIT 6
#define QUARTER_BYTES (1 << QUARTER_BIT)
#define QUARTER_START(number) ((number) * QUARTER_BYTES)

// A USART's registers, counted from its UCSRnA.
#define USART_CONTROL 1
#define USART_DATA 6

// The USART's control while nothing waits to be sent.
#define USART_QUIET (1 << TXEN0 | 1 << RXEN0 | 1 << RXCIE0)
