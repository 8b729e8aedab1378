// Bytes that `in` and `out` reach in one cycle, for the interrupts of the links.
//
// Interrupts here never nest, so one place each keeps what an interrupt saves: half the cycles of a stack.
// GPIOR0..2 are made for such use; timer 0 stands still, and its registers then only store.
#pragma once

#include <avr/io.h>

// Saved by every interrupt of the links while it runs.
#define SCRATCH_R24 OCR0A
#define SCRATCH_R30 OCR0B // or the status register, where r30 is not needed
#define SCRATCH_R31 TCNT0

// The south link's own: docs beside their use in south_uart.cpp.
#define SOUTH_TOGGLES GPIOR0
#define SOUTH_EDGE_TAIL GPIOR1
#define SOUTH_EDGE_HEAD GPIOR2

namespace tilenca {
namespace board {

// Stops timer 0, and with it Arduino's millis(): in this mode a write to OCR0A or OCR0B is there at once.
inline void scratch_begin() {
    TIMSK0 = 0;
    TCCR0A = 0;
    TCCR0B = 0;
}

} // namespace board
} // namespace tilenca
