; The sum of 5 * `fives` messages.
;
;   int16_t tilenca_sum(const int8_t* messages, uint8_t fives)
;                       r25:r24                 r22
    .section .text.tilenca_sum, "ax", @progbits
    .global tilenca_sum
    .type tilenca_sum, @function
tilenca_sum:
    movw r30, r24
    ; Each is added as message + 128, so the sum starts at -128 times their number.
    ldi r25, 5
    mul r22, r25
    mov r25, r0
    clr r24
    lsr r25
    ror r24
    com r25
    neg r24
    sbci r25, 0xFF
    clr r1
1:  .rept 5
    ld r20, Z+
    subi r20, 0x80
    add r24, r20
    adc r25, r1
    .endr
    dec r22
    brne 1b
    ret
    .size tilenca_sum, . - tilenca_sum
