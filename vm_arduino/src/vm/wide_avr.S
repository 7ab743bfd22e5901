; Numbers of 32 bits and more in registers of 8: the steps that `number_avr.S` is made of.
;
; a, b and d are numbers of 32 bits, high stands above a. What a routine says nothing of, it
; leaves; all use r0, and r1 is 0.

#ifdef __AVR__

#include "wide_avr.h"

; For products alone.
#define part0 r12
#define part1 r13
#define carry r28
#define count r29

    .section .text.tiniscript_wide, "ax", @progbits

.macro shared name
    .global \name
\name:
.endm

; Lets a be the number at Z, without its sign.
shared load_magnitude
    rcall load
    sbrs a3, 7
    ret

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

; Lets a be the number at Z.
shared load
    ld a0, Z
    ldd a1, Z+1
    ldd a2, Z+2
    ldd a3, Z+3
    ret

; Leaves the answer in Z, the flag.
shared is_a_zero
    mov r0, a0
    or r0, a1
    or r0, a2
    or r0, a3
    ret

shared negate_d
    com d0
    com d1
    com d2
    com d3                  ; leaves a carry
    adc d0, r1
    adc d1, r1
    adc d2, r1
    adc d3, r1
    ret

shared double_d
    lsl d0
    rol d1
    rol d2
    rol d3
    ret

shared let_d_be_1000
    ldi r26, lo8(1000)
    ldi r27, hi8(1000)
    movw d0, r26
    clr d2
    clr d3
    ret

shared let_b_be_1000
    ldi b0, lo8(1000)
    ldi b1, hi8(1000)
    ldi b2, 0
    ldi b3, 0
    ret

shared widen
    clr high0
    clr high1
    movw high2, high0
    ret

; high and a are a * b. Byte by byte: the lowest byte of a, times b, is added to high, and both
; move down by a byte into the room that it leaves.
shared multiply
    push part0
    push part1
    push carry
    push count
    rcall widen
    ldi count, 4
1:  clr carry
    tst a0
    breq 2f
    mul a0, b0
    movw part0, r0
    mul a0, b2
    add high0, part0
    adc high1, part1
    adc high2, r0
    adc high3, r1
    rol carry
    mul a0, b1
    movw part0, r0
    mul a0, b3
    add high1, part0
    adc high2, part1
    adc high3, r0
    adc carry, r1
2:  mov a0, a1
    mov a1, a2
    mov a2, a3
    mov a3, high0
    mov high0, high1
    mov high1, high2
    mov high2, high3
    mov high3, carry
    dec count
    brne 1b
    clr r1
    pop count
    pop carry
    pop part1
    pop part0
    ret

; As `divide`, rounded half up.
shared divide_and_round
    rcall divide
    lsl high0
    rol high1
    rol high2
    rol high3
    cp high0, d0
    cpc high1, d1
    cpc high2, d2
    cpc high3, d3
    brlo 1f
    subi a0, -1
    sbci a1, -1
    sbci a2, -1
    sbci a3, -1
    brlo 1f
    dec a3                  ; 2^32 stays out of range
1:  ret

; a is high and a, divided by d, or 0xff000000 and more where it does not fit; high is the
; remainder, where it fits. d stays; b is lost.
shared divide
    cp high0, d0
    cpc high1, d1
    cpc high2, d2
    cpc high3, d3
    brlo 2f
    ldi a3, 0xff
    ret
; Bytes of the quotient that are 0 at its beginning come at once.
2:  ldi b0, 32              ; bits
3:  tst high3
    brne 4f
    cp a3, d0
    cpc high0, d1
    cpc high1, d2
    cpc high2, d3
    brsh 4f
    mov high3, high2
    mov high2, high1
    mov high1, high0
    mov high0, a3
    mov a3, a2
    mov a2, a1
    mov a1, a0
    clr a0
    subi b0, 8
    brne 3b
    ret
; Bit by bit.
4:  lsl a0
    rol a1
    rol a2
    rol a3
    rol high0
    rol high1
    rol high2
    rol high3
    cp high0, d0
    cpc high1, d1
    cpc high2, d2
    cpc high3, d3
    brlo 5f
    sub high0, d0
    sbc high1, d1
    sbc high2, d2
    sbc high3, d3
    inc a0
5:  dec b0
    brne 4b
    ret

#endif
