; Computes a layer in blocks of eight outputs, which are side by side in registers. layers.cpp calls it.
;
;   int16_t tilenca_blocks(const uint8_t* blocks, const int8_t* inputs, int16_t sum, void* results,
;                          r25:r24                r23:r22               r21:r20      r19:r18
;                          uint8_t count)
;                          r16
;
; `blocks` is a packed layer in flash, as core/layer.h describes it. -128 follows the last of the `inputs`.
; `sum` is their sum, or anything where every block has 16-bit accumulators. Bits 6..0 of `count` are the
; number of outputs, rounded up to whole blocks. Bit 7 says what happens to them:
;
;   clear  they are stored as activations in the int8 at `results`, and their sum is returned
;   set    they are added to the int16 at `results`
;
; This file and accumulate24.inc use 24-bit accumulators, accumulate16.inc 16-bit ones. In flash the weights
; and biases have offsets that make every product unsigned. A product then adds nothing but its carry to the
; third byte: 8 cycles per weight. To balance the offsets, every sum starts at minus 32768 and 128 times the
; sum of the inputs. A row whose input is zero is skipped, and one whose input is negative is subtracted. The last
; five outputs or fewer have shorter rows. Interrupts may come at any time. Stack: 33 bytes with the return
; address.

#include "accumulate24.inc"

#define SPL 0x3d
#define SPH 0x3e

; The frame, from Y + 1.
#define SUM 1
#define INPUTS 3
#define START 5
#define COUNT_AT 8
#define RESULTS 9

    .section .text.tilenca_blocks, "ax", @progbits
    .global tilenca_blocks
    .type tilenca_blocks, @function
tilenca_blocks:
    .irp saved, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 28, 29
    push r\saved
    .endr
    movw r30, r24
    ; Every sum starts at its bias plus r26:r25:r24, which is 32 to round an activation, minus the offsets.
    asr r21
    ror r20
    clr r17
    ror r17
    ldi r24, 32
    sbrc r16, 7
    clr r24
    sub r24, r17
    ldi r25, 0x80
    sbc r25, r20
    ldi r26, 0xFF
    sbc r26, r21
    .irp argument, 19, 18, 16, 26, 25, 24, 23, 22, 1, 1
    push r\argument
    .endr

.Lblock:
    in r28, SPL
    in r29, SPH
    clr r1
    lpm r0, Z+
    cpse r0, r1
    rjmp .Lblock16
.Lblock24:
    ; T: the last layer has five outputs left or fewer. In the others the rest of a block must become zeros.
    ldd r16, Y + COUNT_AT
    subi r16, 0x80
    subi r16, 6
    sbc r16, r16
    bst r16, 0
    ldd r26, Y + START
    ldd r27, Y + START + 1
    ldd r0, Y + START + 2
    each start_sum 0
    ldd r26, Y + INPUTS
    ldd r27, Y + INPUTS + 1
    clr ZERO
    brtc 9f
    rjmp .Lfew_rows
9:  rows each
    rjmp .Lend_of_rows
.Lfew_rows:
    rows five, 3
.Lend_of_rows:
    in r28, SPL
    in r29, SPH
    ldd r26, Y + RESULTS
    ldd r27, Y + RESULTS + 1
    ldd r0, Y + COUNT_AT
    sbrc r0, 7
    rjmp .Lto_state
    ldi r28, 127
    mov r1, r28
    ldi r28, 32
    mov r0, r28
    activate_two r2, r3, r4, r5, r6, r7
    clr r2
    clr r4
    activate_next_two r8, r9, r10, r11, r12, r13
    activate_next_two r14, r15, r16, r17, r18, r19
    activate_next_two r20, r21, r22, r23, r24, r25
    in r28, SPL
    ldd r16, Y + SUM
    ldd r17, Y + SUM + 1
    add r16, r3
    adc r17, r4
    std Y + SUM, r16
    std Y + SUM + 1, r17
    std Y + RESULTS, r26
    std Y + RESULTS + 1, r27
    ldd r16, Y + COUNT_AT
    subi r16, 8
    std Y + COUNT_AT, r16
    breq .Ldone
    brcs .Ldone
    rjmp .Lblock

.Ldone:
    pop r24
    pop r25
.Ldone_but_sum:
    .irp ignored, 3, 4, 5, 6, 7, 8, 9, 10
    pop r0
    .endr
    .irp saved, 29, 28, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2
    pop r\saved
    .endr
    clr r1
    ret

; Z reads the sums through the chip's register addresses: r2 is at address 2. r4 is read before it is written.
.Lto_state:
    ldd r28, Y + COUNT_AT
    andi r28, 0x7F
    cpi r28, 8
    brlo 9f
    ldi r28, 8
9:  push r30
    push r31
    ldi r30, 2
    clr r31
1:  ld r0, Z+
    ld r1, Z+
    ld r29, Z+
    mov r4, r28
    ld r28, X+
    add r0, r28
    ld r28, X
    adc r1, r28
    brcc 2f
    inc r29
2:  sbrc r28, 7
    dec r29
    ; r29:r1:r0 is the new state. Limit it to -0x3F80..0x3F80.
    tst r29
    brmi 3f
    ldi r28, 0x3F
    brne 4f
    cp r1, r28
    brlo 5f
    brne 4f
    sbrs r0, 7
    rjmp 5f
    rjmp 4f
3:  ldi r28, 0xC0
    inc r29
    brne 4f
    cp r28, r1
    brlo 5f
    brne 4f
    sbrc r0, 7
    rjmp 5f
4:  mov r1, r28
    ldi r28, 0x80
    mov r0, r28
5:  st X, r1
    st -X, r0
    adiw r26, 2
    mov r28, r4
    dec r28
    brne 1b
    pop r31
    pop r30
    in r28, SPL
    in r29, SPH
    std Y + RESULTS, r26
    std Y + RESULTS + 1, r27
    ldd r16, Y + COUNT_AT
    subi r16, 8
    std Y + COUNT_AT, r16
    cpi r16, 0x81
    brsh 9f
    rjmp .Ldone
9:  rjmp .Lblock

#include "accumulate16.inc"
    .size tilenca_blocks, . - tilenca_blocks
