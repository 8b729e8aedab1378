; The millisecond's interrupt, which also lights the link LEDs, and the one that darkens them.
;
; Their pins have no PWM. Each LED is lit in every fourth millisecond, so that never two draw their current at
; once, and until timer 4's count reaches the brightness. By hand, like the interrupts of the links. Only
; interrupts write PORTK, and they never nest.

#include "board/scratch.h"

    .section .text.tilenca_clock, "ax", @progbits

    .global TIMER4_OVF_vect
    .type TIMER4_OVF_vect, @function
TIMER4_OVF_vect:
    out _SFR_IO_ADDR(SCRATCH_R24), r24
    in r24, _SFR_IO_ADDR(SREG)
    out _SFR_IO_ADDR(SCRATCH_R30), r24
    out _SFR_IO_ADDR(SCRATCH_R31), r31
    lds r24, tilenca_ticks
    inc r24
    sts tilenca_ticks, r24
    lds r31, tilenca_leds
    sbrc r24, 0 ; of the four the one whose turn it is
    andi r31, 0x0A
    sbrs r24, 0
    andi r31, 0x05
    sbrc r24, 1
    andi r31, 0x0C
    sbrs r24, 1
    andi r31, 0x03
    lds r24, _SFR_MEM_ADDR(PORTK)
    andi r24, 0xF0
    or r24, r31
    sts _SFR_MEM_ADDR(PORTK), r24
    in r31, _SFR_IO_ADDR(SCRATCH_R31)
    in r24, _SFR_IO_ADDR(SCRATCH_R30)
    out _SFR_IO_ADDR(SREG), r24
    in r24, _SFR_IO_ADDR(SCRATCH_R24)
    reti
    .size TIMER4_OVF_vect, . - TIMER4_OVF_vect

    .global TIMER4_COMPA_vect
    .type TIMER4_COMPA_vect, @function
TIMER4_COMPA_vect:
    out _SFR_IO_ADDR(SCRATCH_R24), r24
    in r24, _SFR_IO_ADDR(SREG)
    out _SFR_IO_ADDR(SCRATCH_R30), r24
    lds r24, _SFR_MEM_ADDR(PORTK)
    andi r24, 0xF0
    sts _SFR_MEM_ADDR(PORTK), r24
    in r24, _SFR_IO_ADDR(SCRATCH_R30)
    out _SFR_IO_ADDR(SREG), r24
    in r24, _SFR_IO_ADDR(SCRATCH_R24)
    reti
    .size TIMER4_COMPA_vect, . - TIMER4_COMPA_vect
