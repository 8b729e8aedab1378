// Bytes that `in` and `out` reach in one cycle, for the interrupts of the links. Read by the assembler too.
//
// Interrupts here never nest, so one place each keeps what an interrupt saves: half the cycles of a stack.
// GPIOR0..2 are made for such use. Timer 0 is stopped, and its registers then only store.
#pragma once

#include <avr/io.h>

// Saved by every interrupt of the links while it runs.
#define SCRATCH_R24 OCR0A
#define SCRATCH_R30 OCR0B // or the status register, where r30 is not needed
#define SCRATCH_R31 TCNT0

// Used by the south link only; south_layout.h describes them.
#define SOUTH_TOGGLES GPIOR0
#define SOUTH_EDGE_TAIL GPIOR1
#define SOUTH_EDGE_HEAD GPIOR2

#ifndef __ASSEMBLER__

namespace tilenca {
namespace board {

// Stops timer 0, and with it Arduino's millis(): in this mode a write to OCR0A or OCR0B takes effect at once.
inline void scratch_begin() {
    TIMSK0 = 0;
    TCCR0A = 0;
    TCCR0B = 0;
}

} // namespace board
} // namespace tilenca

#endif
