; The rounds of `siphash.h` for the AVR, in its own language: a carry goes from byte to byte by
; itself, and both words of a step stay in X and Z.
;
; Means the same as `siphash_portable.cpp`, which is for all other chips. Takes 108 bytes of flash less,
; without which an Uno would have no owners. A chip with more flash in its place, or 108 bytes to spare,
; lets it go: then delete this file. Calls are those of avr-gcc, as in `number_avr.S`.
; `test_a_tag_takes_milliseconds_and_a_claim_survives_a_reset` compares the two: one hash takes every
; path here, and a wrong one opens no robot.

#ifdef __AVR__

#define bytes 8                 /* of a word */

#define left r18                /* bytes of the word */
#define value r19
#define row0 r20                /* of `quarters`, where the next number is */
#define row1 r21
#define rounds r22
#define bits r23
#define state0 r24
#define state1 r25

    .section .progmem.data.siphash, "a", @progbits

; The quarters of a round, as in `siphash.cpp`.
quarters:
    .byte 0 * bytes, 1 * bytes, 13, 32
    .byte 2 * bytes, 3 * bytes, 16, 0
    .byte 0 * bytes, 3 * bytes, 21, 0
    .byte 2 * bytes, 1 * bytes, 17, 32
quarters_end:

    .section .text.siphash, "ax", @progbits

; void xor_word(uint8_t* word, const uint8_t* other)
    .global _ZN10tiniscript8xor_wordEPhPKh
    .type _ZN10tiniscript8xor_wordEPhPKh, @function
_ZN10tiniscript8xor_wordEPhPKh:
    movw r30, r24
    movw r26, r22
; The word at Z by the one at X. Both pointers lie behind their words then.
xor_z_by_x:
    ldi left, bytes
1:
    ld value, Z
    ld r0, X+
    eor value, r0
    st Z+, value
    dec left
    brne 1b
    ret

; Rotates the word at Z to the left by `bits`.
rotate_bit:
    ldd value, Z+7
    lsl value                   ; its highest bit becomes the lowest one
    ldi left, bytes
1:
    ld value, Z
    rol value
    st Z+, value
    dec left                    ; leaves the carry, as ldi and st do
    brne 1b
    sbiw r30, bytes
rotate:
    subi bits, 1
    brcc rotate_bit
    ret

; void sip_rounds(uint8_t* state, uint8_t rounds)
    .global _ZN10tiniscript10sip_roundsEPhh
    .type _ZN10tiniscript10sip_roundsEPhh, @function
_ZN10tiniscript10sip_roundsEPhh:
    ldi row0, lo8(quarters)
    ldi row1, hi8(quarters)
quarter:
    movw r30, row0
    lpm left, Z+
    lpm value, Z+
    lpm bits, Z+
    movw row0, r30
    movw r26, state0            ; X: the first word
    add r26, left
    adc r27, r1
    movw r30, state0            ; Z: the second one
    add r30, value
    adc r31, r1                 ; leaves no carry
    ldi left, bytes
1:
    ld r0, X
    ld value, Z+
    adc r0, value
    st X+, r0
    dec left
    brne 1b
    sbiw r26, bytes
    sbiw r30, bytes
    rcall rotate
    rcall xor_z_by_x
    sbiw r26, bytes
    movw r30, row0
    lpm bits, Z+
    movw row0, r30
    movw r30, r26
    rcall rotate
    cpi row0, lo8(quarters_end)
    brne quarter
    dec rounds
    brne _ZN10tiniscript10sip_roundsEPhh
    ret

#endif
