; Whole numbers of 32 bits and more in registers of 8: the steps that `number_avr.S` is made of.
;
; a and b are numbers of 32 bits, high stands above b: 64 bits together. What a routine says nothing
; of, it leaves; all use r0. r1 is 0 before and after.

#include "build.h"

#ifdef tiniscript_in_assembly

#include "wide_avr.h"

    .section .text.tiniscript_wide, "ax", @progbits

.macro shared name
    .global \name
\name:
.endm

; Leaves V where there is no such number.
shared negate_a
    com a3
    com a2
    com a1
    neg a0
    sbci a1, -1
    sbci a2, -1
    sbci a3, -1
    ret

shared negate_b
    com b3
    com b2
    com b1
    neg b0
    sbci b1, -1
    sbci b2, -1
    sbci b3, -1
    ret

; Leaves the answer in Z, the flag.
shared is_a_zero
    mov r0, a0
    or r0, a1
    or r0, a2
    or r0, a3
    ret

shared is_b_zero
    mov r0, b0
    or r0, b1
    or r0, b2
    or r0, b3
    ret

; high and b are b * a. Byte by byte: the lowest byte of b, times a, is added to high, and both move
; down by a byte into the room that it leaves.
shared multiply
    clr high0
    clr high1
    movw high2, high0
    rcall 1f
    rcall 1f
    rcall 1f
1:  clr carry
    tst b0
    breq 2f
    mul b0, a0
    movw part0, r0
    mul b0, a2
    add high0, part0
    adc high1, part1
    adc high2, r0
    adc high3, r1
    rol carry
    mul b0, a1
    movw part0, r0
    mul b0, a3
    add high1, part0
    adc high2, part1
    adc high3, r0
    adc carry, r1
    clr r1
2:  mov b0, b1
    mov b1, b2
    mov b2, b3
    mov b3, high0
    mov high0, high1
    mov high1, high2
    mov high2, high3
    mov high3, carry
    ret

; b is high and b, divided by a; high is what is left. Leaves a carry where b has no room for it.
; Uses part1.
shared divide
    cp high0, a0
    cpc high1, a1
    cpc high2, a2
    cpc high3, a3
    brlo 1f
    sec
    ret
1:  rcall divide_byte
    rcall divide_byte
    rcall divide_byte
    rcall divide_byte
    clc
    ret

; What the compiler calls for a / b: b is the quotient, a what is left. Its own is larger and slower.
; Signed numbers keep a sign in r0 meanwhile.
shared __udivmodsi4
    push r0
    push part1
    movw high0, a0
    movw high2, a2
    movw a0, b0
    movw a2, b2
    movw b0, high0
    movw b2, high2
    clr high0
    clr high1
    movw high2, high0
    rcall divide
    movw a0, high0
    movw a2, high2
    pop part1
    pop r0
    ret

; The highest byte of b becomes one of the quotient, the lowest. It is 0 at once, or comes bit by
; bit.
divide_byte:
    mov r0, b3
    mov b3, b2
    mov b2, b1
    mov b1, b0
    mov b0, r0
    tst high3
    brne 2f
    cp r0, a0
    cpc high0, a1
    cpc high1, a2
    cpc high2, a3
    brsh 2f
    mov high3, high2
    mov high2, high1
    mov high1, high0
    mov high0, r0
    ldi b0, 0
    ret
2:  sec
    clr part1               ; leaves the carry
    ror part1               ; a bit that leaves it behind eight
3:  lsl b0
    rol high0
    rol high1
    rol high2
    rol high3
    cp high0, a0
    cpc high1, a1
    cpc high2, a2
    cpc high3, a3
    brlo 4f
    sub high0, a0
    sbc high1, a1
    sbc high2, a2
    sbc high3, a3
    inc b0
4:  lsr part1
    brcc 3b
    ret

; As `divide`, rounded half up. high is lost.
shared divide_and_round
    rcall divide
    brcs 2f
    lsl high0
    rol high1
    rol high2
    rol high3
    cp high0, a0
    cpc high1, a1
    cpc high2, a2
    cpc high3, a3
    brsh 1f
    clc
    ret
1:  subi b0, -1
    sbci b1, -1
    sbci b2, -1
    sbci b3, -1             ; a carry, but for 2^32
    brcc 3f
    clc
2:  ret
3:  sec
    ret

; b is high and b, divided by 1000, rounded half up. Leaves a carry where b has no room for it. high
; is lost.
;
; 1000 is 8 * 125, and 256 is 2 * 125 + 6: with what is left of the bytes above, which is less than
; 125, the next byte of the quotient is twice that, and a few more.
shared divide_by_1000
    or high2, high3
    brne 3b
    cpi high1, 2
    brsh 3b
    subi b0, lo8(-500)
    sbci b1, hi8(-500)
    sbci b2, -1
    sbci b3, -1
    sbci high0, -1
    sbci high1, -1
    ldi high2, 3
4:  lsr high1
    ror high0
    ror b3
    ror b2
    ror b1
    ror b0
    dec high2               ; leaves 0
    brne 4b
    cpi high0, 125
    brsh 3b
    ldi high3, 6
    rcall 5f
    rcall 5f
    rcall 5f
    rcall 5f
    clr r1
    clc
    ret
5:  mov high1, b3
    mov b3, b2
    mov b2, b1
    mov b1, b0
    mul high0, high3        ; and the next byte: less than 1000
    add r0, high1
    adc r1, high2
    lsl r0                  ; 128 of them are 125 and 3
    rol r1
    lsr r0
    lsl high0
    add high0, r1
    mov high1, r0
    add high1, r1
    add high1, r1
    add high1, r1
    cpi high1, 125
    brlo 6f
    subi high1, 125
    inc high0
6:  mov b0, high0
    mov high0, high1
    ret

#endif
