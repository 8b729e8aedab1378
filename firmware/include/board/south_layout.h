// What south_uart.cpp shares with its interrupts in avr/south_uart.S. Read by the assembler too, so only
// macros.
//
// The ring of edges has its head in SOUTH_EDGE_HEAD and its tail in SOUTH_EDGE_TAIL. An edge's index is the
// place of its time's low byte and of port K's levels. The time's high byte lies one further.
//
// SOUTH_TOGGLES holds the toggles that are shifted out, the next one in bit 7.
#pragma once

// What SOUTH_TOGGLES holds when all its toggles are out (kNoMoreToggles).
#define SOUTH_NO_TOGGLES 0x80

// The sending pin's bit of port K.
#define SOUTH_TX_MASK 0x80
