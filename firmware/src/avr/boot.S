; What runs before the C++ start-up code, and the watchdog's interrupt, which starts the program again.

#include <avr/io.h>

#include "board/boot_layout.h"

.macro watchdog_off
    wdr
    ldi r24, 1 << WDCE | 1 << WDE
    sts _SFR_MEM_ADDR(WDTCSR), r24
    sts _SFR_MEM_ADDR(WDTCSR), r1
.endm

; Between .init2, which clears r1 and sets the stack, and .init4, which clears memory.
    .section .init3, "ax", @progbits
    in r22, _SFR_IO_ADDR(MCUSR)
    out _SFR_IO_ADDR(MCUSR), r1
    watchdog_off ; a watchdog that has reset the chip runs on
    mov r24, r22
    call tilenca_survive
    ; From where the variables end to the end of SRAM; nothing is on the stack.
    ldi r30, lo8(__heap_start)
    ldi r31, hi8(__heap_start)
    ldi r24, STACK_PAINT
    ldi r25, hi8(RAMEND + 1)
1:  st Z+, r24
    cpi r30, lo8(RAMEND + 1)
    cpc r31, r25
    brne 1b

; Returns to address 0 instead of where the program hung. All that could interrupt the start-up code is off
; before.
    .section .text.tilenca_watchdog, "ax", @progbits
    .global WDT_vect
    .type WDT_vect, @function
WDT_vect:
    clr r1
    pop r18
    pop r19
    pop r20
    push r1
    push r1
    push r1
    sts tilenca_survivors + SURVIVORS_HUNG_AT + 2, r18
    sts tilenca_survivors + SURVIVORS_HUNG_AT + 1, r19
    sts tilenca_survivors + SURVIVORS_HUNG_AT, r20
    .irp byte, 0, 1, 2, 3
    ldi r24, (MARK_HUNG >> (8 * \byte)) & 0xFF
    sts tilenca_survivors + SURVIVORS_MARK + \byte, r24
    .endr
    .irp mask, TIMSK0, TIMSK1, TIMSK2, TIMSK3, TIMSK4, TIMSK5, UCSR0B, UCSR1B, UCSR2B, UCSR3B, PCICR
    sts _SFR_MEM_ADDR(\mask), r1
    .endr
    watchdog_off
    reti
    .size WDT_vect, . - WDT_vect
