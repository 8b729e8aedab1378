; The interrupts of the four USARTs. They do what put() and take() of board/ring.h do.
;
; By hand, in half the compiler's cycles and without a change of flags: while one of these runs, an edge of
; the south link waits for its time stamp. Z is the pointer, r24 the byte.

#include "board/scratch.h"
#include "board/usart_layout.h"

.macro enter
    out _SFR_IO_ADDR(SCRATCH_R24), r24
    out _SFR_IO_ADDR(SCRATCH_R30), r30
    out _SFR_IO_ADDR(SCRATCH_R31), r31
.endm

.macro leave
    in r31, _SFR_IO_ADDR(SCRATCH_R31)
    in r30, _SFR_IO_ADDR(SCRATCH_R30)
    in r24, _SFR_IO_ADDR(SCRATCH_R24)
    reti
.endm

; From past the last byte of USART n's quarter back to its first. QUARTER_BIT is clear inside an even quarter
; and set inside an odd one.
.macro wrap number
    .if \number % 2
    sbrs r30, QUARTER_BIT
    .else
    sbrc r30, QUARTER_BIT
    .endif
    ldi r30, QUARTER_START(\number)
.endm

.macro handler vector
    .global \vector
    .type \vector, @function
\vector:
.endm

; Adds one to a counter, up to 65,535, and returns. Keeps r24 and the flags.
.macro count counter
    push r24
    in r24, _SFR_IO_ADDR(SREG)
    push r24
    lds r30, \counter
    lds r31, \counter + 1
    adiw r30, 1
    breq 5f
    sts \counter + 1, r31
    sts \counter, r30
5:  pop r24
    out _SFR_IO_ADDR(SREG), r24
    pop r24
    ret
.endm

; A byte has come. `registers`: the address of UCSRnA.
.macro receive vector, number, registers
    handler \vector
    enter
    lds r31, \registers
    lds r24, \registers + USART_DATA
    sbrc r31, DOR0
    rjmp 3f
    sbrc r31, FE0
    rjmp 6f
1:  ldi r31, hi8(tilenca_received_page)
    lds r30, tilenca_received + RING_BYTES * \number + RING_HEAD
    st Z+, r24 ; without effect if there is no room, since the head then stays
    wrap \number
    lds r24, tilenca_received + RING_BYTES * \number + RING_TAIL
    cpse r30, r24
    rjmp 2f
    rcall 4f
    leave
2:  sts tilenca_received + RING_BYTES * \number + RING_HEAD, r30
    leave
3:  rcall 4f ; the USART itself lost a byte before this one
    rjmp 1b
6:  rcall 7f ; the byte has no stop bit
    rjmp 1b
4:  count tilenca_usart_overruns + 2 * \number
7:  count tilenca_usart_framing_errors + 2 * \number
    .size \vector, . - \vector
.endm

; The data register is empty. `ring` and `page` are the queue. An index into a whole page wraps by itself.
.macro send vector, number, registers, ring, page, quarter=1
    handler \vector
    enter
    lds r30, \ring + RING_TAIL
    lds r24, \ring + RING_HEAD
    cpse r30, r24
    rjmp 1f
    ldi r24, USART_QUIET ; nothing is left: no more interrupts
    sts \registers + USART_CONTROL, r24
    leave
1:  ldi r31, hi8(\page)
    ld r24, Z+
    sts \registers + USART_DATA, r24
    .if \quarter
    wrap \number
    .endif
    sts \ring + RING_TAIL, r30
    leave
    .size \vector, . - \vector
.endm

.macro send_quarter vector, number, registers
    send \vector, \number, \registers, tilenca_sending + RING_BYTES * \number, tilenca_sending_page
.endm

    .section .text.tilenca_usart, "ax", @progbits
    receive USART0_RX_vect, 0, _SFR_MEM_ADDR(UCSR0A)
    receive USART1_RX_vect, 1, _SFR_MEM_ADDR(UCSR1A)
    receive USART2_RX_vect, 2, _SFR_MEM_ADDR(UCSR2A)
    receive USART3_RX_vect, 3, _SFR_MEM_ADDR(UCSR3A)

    ; USART 0 is the host's.
    send USART0_UDRE_vect, 0, _SFR_MEM_ADDR(UCSR0A), tilenca_host_sending, tilenca_host_page, quarter=0
    send_quarter USART1_UDRE_vect, 1, _SFR_MEM_ADDR(UCSR1A)
    send_quarter USART2_UDRE_vect, 2, _SFR_MEM_ADDR(UCSR2A)
    send_quarter USART3_UDRE_vect, 3, _SFR_MEM_ADDR(UCSR3A)
