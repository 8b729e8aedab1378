; One pass of a layer: eight outputs of core/network.h, side by side in registers.
;
;   int16_t tilenca_pass(const uint8_t* pass, const int8_t* inputs, int32_t start, void* results, uint8_t how)
;                        r25:r24              r23:r22               r20:r18        r17:r16        r14
;
; `pass` in flash: eight int16 biases, then for each input eight weights as weight + 128. `inputs` end with
; -128. Every sum starts at its bias plus `start`. `how`, bits 6..0: 0 for a hidden layer, whose eight outputs
; go to `results` and whose sum is returned; else as many sums are added to the int16 states at `results`.
; Bit 7: 16 bits hold the sums.
;
; Weights + 128 make every product unsigned, so its carry is all that a third byte needs: 8 cycles per
; weight. The sum of the inputs, times 128, is in `start`. An input of zero skips its row; that of a negative
; one is subtracted. Interrupts may come at any time; 24 bytes of stack with the return address.

; r25:r2: eight sums of three bytes. r1:r0: a product.
#define INPUT r28
#define ZERO r29
; X: the next input. Z: the next weight.

.macro each what:vararg
    \what, r2, r3, r4
    \what, r5, r6, r7
    \what, r8, r9, r10
    \what, r11, r12, r13
    \what, r14, r15, r16
    \what, r17, r18, r19
    \what, r20, r21, r22
    \what, r23, r24, r25
.endm

; The bias plus r0:r29:r28.
.macro start_sum ignored, low, middle, high
    lpm \low, Z+
    lpm \middle, Z+
    mov \high, \middle
    lsl \high
    sbc \high, \high
    add \low, r28
    adc \middle, r29
    adc \high, r0
.endm

.macro multiply24 add, adc, low, middle, high
    lpm r0, Z+
    mul r0, INPUT
    \add \low, r0
    \adc \middle, r1
    \adc \high, ZERO
.endm

.macro multiply16 add, adc, low, middle, high
    lpm r0, Z+
    mul r0, INPUT
    \add \low, r0
    \adc \middle, r1
.endm

.macro extend_sign ignored, low, middle, high
    mov \high, \middle
    lsl \high
    sbc \high, \high
.endm

; All rows. Falls out at the end.
.macro rows multiply
    rjmp 3f
1:  ; a positive input
    each \multiply add, adc
    ld INPUT, X+
    cp ZERO, INPUT
    brlt 1b
    brne 4f
2:  ; zero
    adiw r30, 8
3:  ; any
    ld INPUT, X+
    cp ZERO, INPUT
    breq 2b
    brlt 1b
4:  ; a negative one; only the end is its own negative
    neg INPUT
    brvs 6f
    each \multiply sub, sbc
    ld INPUT, X+
    cp ZERO, INPUT
    breq 2b
    brge 4b
    rjmp 1b
6:
.endm

; Scales a sum to 0..127; X: where to; r28 = 127; Z: the sum of all.
.macro activate ignored, low, middle, high
    tst \high
    brmi 2f
    brne 1f
    lsl \low
    rol \middle
    brcs 1f
    lsl \low
    rol \middle
    brcs 1f
    brpl 3f
1:  mov \middle, r28
    rjmp 3f
2:  clr \middle
3:  st X+, \middle
    add r30, \middle
    adc r31, ZERO
.endm

    .section .text.tilenca_pass, "ax", @progbits
    .global tilenca_pass
    .type tilenca_pass, @function
tilenca_pass:
    .irp saved, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 28, 29
    push r\saved
    .endr
    push r16
    push r17
    push r14
    bst r14, 7
    movw r26, r22
    movw r30, r24
    movw r28, r18
    mov r0, r20
    each start_sum 0
    clr ZERO
    brtc 9f
    rjmp narrow
9:  rows multiply24
    rjmp finish
narrow:
    rows multiply16
    each extend_sign 0

finish:
    pop r28
    pop r27
    pop r26
    andi r28, 0x7F
    breq 9f
    rjmp add_to_states
9:  ldi r28, 127
    clr r30
    clr r31
    each activate 0
restore:
    .irp saved, 29, 28, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2
    pop r\saved
    .endr
    movw r24, r30
    clr r1
    ret

; Z walks through the sums where the chip maps its registers: r2 is at address 2.
add_to_states:
    ldi r30, 2
    clr r31
1:  push r28
    ld r0, Z+
    ld r28, X+
    add r0, r28
    ld r1, Z+
    ld r28, X
    adc r1, r28
    ld r29, Z+
    brcc 2f
    inc r29
2:  sbrc r28, 7
    dec r29
    ; r29:r1:r0 is the new state, to be kept in -0x3F80..0x3F80
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
    pop r28
    dec r28
    brne 1b
    rjmp restore
    .size tilenca_pass, . - tilenca_pass
