; The interrupts of the south link's software UART: a bit leaves, and an edge is stamped.
;
; By hand, in half the compiler's cycles: every other interrupt waits for these, and a receiver tolerates only
; half a bit of delay in all.

#include "board/scratch.h"
#include "board/south_layout.h"

    .section .text.tilenca_south_uart, "ax", @progbits

; Changes the line first, so that every edge has the same delay. Every seventh time it then loads the next
; toggles.
    .global TIMER1_OVF_vect
    .type TIMER1_OVF_vect, @function
TIMER1_OVF_vect:
    out _SFR_IO_ADDR(SCRATCH_R24), r24
    in r24, _SFR_IO_ADDR(SREG)
    out _SFR_IO_ADDR(SCRATCH_R30), r24
    in r24, _SFR_IO_ADDR(SOUTH_TOGGLES)
    lsl r24
    out _SFR_IO_ADDR(SOUTH_TOGGLES), r24
    brcc 1f
    ldi r24, SOUTH_TX_MASK
    sts _SFR_MEM_ADDR(PINK), r24
    in r24, _SFR_IO_ADDR(SOUTH_TOGGLES)
1:  cpi r24, SOUTH_NO_TOGGLES
    brne 3f
    push r30
    push r31
    lds r30, tilenca_toggles_at
    ldi r31, hi8(tilenca_toggles)
    ld r24, Z+
    sts tilenca_toggles_at, r30
    pop r31
    pop r30
    out _SFR_IO_ADDR(SOUTH_TOGGLES), r24
    cpi r24, SOUTH_NO_TOGGLES
    brne 3f
    ldi r24, 0
    sts _SFR_MEM_ADDR(TIMSK1), r24 ; all are out: no more interrupts
3:  in r24, _SFR_IO_ADDR(SCRATCH_R30)
    out _SFR_IO_ADDR(SREG), r24
    in r24, _SFR_IO_ADDR(SCRATCH_R24)
    reti
    .size TIMER1_OVF_vect, . - TIMER1_OVF_vect

; Stores timer 5's count and port K's levels. It changes no flag, so none has to be saved.
    .global PCINT2_vect
    .type PCINT2_vect, @function
PCINT2_vect:
    out _SFR_IO_ADDR(SCRATCH_R24), r24
    out _SFR_IO_ADDR(SCRATCH_R30), r30
    out _SFR_IO_ADDR(SCRATCH_R31), r31
    lds r24, _SFR_MEM_ADDR(TCNT5) ; the low byte first: it latches the high one
    in r30, _SFR_IO_ADDR(SOUTH_EDGE_HEAD)
    ldi r31, hi8(tilenca_edge_lows)
    st Z, r24
    lds r24, _SFR_MEM_ADDR(PINK)
    ldi r31, hi8(tilenca_edge_levels)
    st Z+, r24
    lds r24, _SFR_MEM_ADDR(TCNT5) + 1
    ldi r31, hi8(tilenca_edge_highs)
    st Z, r24
    in r24, _SFR_IO_ADDR(SOUTH_EDGE_TAIL)
    cpse r30, r24
    rjmp 1f
    ldi r24, 0
    sts _SFR_MEM_ADDR(PCICR), r24 ; no room: no more interrupts
    rjmp 2f
1:  out _SFR_IO_ADDR(SOUTH_EDGE_HEAD), r30
2:  in r31, _SFR_IO_ADDR(SCRATCH_R31)
    in r30, _SFR_IO_ADDR(SCRATCH_R30)
    in r24, _SFR_IO_ADDR(SCRATCH_R24)
    reti
    .size PCINT2_vect, . - PCINT2_vect
