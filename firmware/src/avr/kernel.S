; Outputs of a layer, eight at a time side by side in registers: the functions of core/network.h on the chip.
;
;   int16_t tilenca_passes(const uint8_t* passes, const int8_t* inputs, int32_t start, void* results,
;                          r25:r24                r23:r22               r20:r18        r17:r16
;                          uint8_t count, uint8_t to_state)
;                          r14            r12
;
; `passes` in flash: for each pass 1 if 16 bits hold all its sums, else 0; eight biases + 32768 as uint16; then
; for each input eight weights + 128. `inputs` end with -128. A sum starts with its bias plus `start`. The first
; `count` outputs, rounded up to whole passes, go to the int8 at `results` as activations, and their sum is
; returned; or, `to_state`, they are added to the int16 at `results`, `count` of them.
;
; Offsets make every product unsigned, so that its carry is all a third byte needs: 8 cycles per weight. What
; is too much, 128 times the sum of the inputs and 32768, is in `start`. An input of zero skips its row, that
; of a negative one is subtracted. Interrupts may come at any time. Stack: 32 bytes with the return address.

; r25:r2: eight sums of three bytes. r1:r0: a product. X: the next input. Z: the next weight.
#define INPUT r28
#define ZERO r29
#define SPL 0x3d
#define SPH 0x3e

; The frame, from Y + 1.
#define SUM 1
#define INPUTS 3
#define START 5
#define TO_STATE 8
#define COUNT 9
#define RESULTS 10
#define FRAME 11

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

; The bias plus r0:X; r1 is zero.
.macro start_sum ignored, low, middle, high
    lpm \low, Z+
    lpm \middle, Z+
    mov \high, r0
    add \low, r26
    adc \middle, r27
    adc \high, r1
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
    brvs 5f
    each \multiply sub, sbc
    ld INPUT, X+
    cp ZERO, INPUT
    breq 2b
    brge 4b
    rjmp 1b
5:
.endm

; Scales a sum to 0..127 and stores it at X. r0 is 32, r1 is 127.
.macro activate low, middle, high
    tst \high
    brne 2f
    cp \middle, r0
    brlo 3f
1:  mov \middle, r1
    rjmp 4f
2:  brpl 1b
    clr \middle
    rjmp 4f
3:  lsl \low
    rol \middle
    lsl \low
    rol \middle
4:  st X+, \middle
.endm

; The same, and adds it to r4:r3; r2 is zero.
.macro activate_next low, middle, high
    activate \low, \middle, \high
    add r3, \middle
    adc r4, r2
.endm

    .section .text.tilenca_passes, "ax", @progbits
    .global tilenca_passes
    .type tilenca_passes, @function
tilenca_passes:
    .irp saved, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 28, 29
    push r\saved
    .endr
    .irp argument, 17, 16, 14, 12, 20, 19, 18, 23, 22, 1, 1
    push r\argument
    .endr
    movw r30, r24

.Lpass:
    in r28, SPL
    in r29, SPH
    ldd r26, Y + START
    ldd r27, Y + START + 1
    lpm r0, Z+
    bst r0, 0
    ldd r0, Y + START + 2
    clr r1
    each start_sum 0
    ldd r26, Y + INPUTS
    ldd r27, Y + INPUTS + 1
    clr ZERO
    brtc 9f
    rjmp .Lnarrow
9:  rows multiply24
    rjmp .Lend_of_rows
.Lnarrow:
    rows multiply16
    each extend_sign 0

.Lend_of_rows:
    in r28, SPL
    in r29, SPH
    ldd r26, Y + RESULTS
    ldd r27, Y + RESULTS + 1
    ldd r0, Y + TO_STATE
    tst r0
    breq 9f
    rjmp .Lto_state

9:  ldi r28, 127
    mov r1, r28
    ldi r28, 32
    mov r0, r28
    activate r2, r3, r4
    clr r2
    clr r4
    activate_next r5, r6, r7
    activate_next r8, r9, r10
    activate_next r11, r12, r13
    activate_next r14, r15, r16
    activate_next r17, r18, r19
    activate_next r20, r21, r22
    activate_next r23, r24, r25
    in r28, SPL
    ldd r16, Y + SUM
    ldd r17, Y + SUM + 1
    add r16, r3
    adc r17, r4
    std Y + SUM, r16
    std Y + SUM + 1, r17

.Lnext_pass:
    std Y + RESULTS, r26
    std Y + RESULTS + 1, r27
    ldd r16, Y + COUNT
    subi r16, 8
    std Y + COUNT, r16
    breq 9f
    brcs 9f
    rjmp .Lpass

9:  pop r24
    pop r25
    .irp ignored, 3, 4, 5, 6, 7, 8, 9, 10, 11
    pop r0
    .endr
    .irp saved, 29, 28, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2
    pop r\saved
    .endr
    clr r1
    ret

; Z walks through the sums where the chip maps its registers: r2 is at address 2.
.Lto_state:
    ldd r28, Y + COUNT
    cpi r28, 8
    brlo 9f
    ldi r28, 8
9:  push r30
    push r31
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
    ; r29:r1:r0 is the new state, to be kept within 0x3F80 of zero.
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
    pop r31
    pop r30
    in r28, SPL
    in r29, SPH
    rjmp .Lnext_pass
    .size tilenca_passes, . - tilenca_passes
