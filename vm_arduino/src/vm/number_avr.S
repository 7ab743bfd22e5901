; The arithmetic of `number.h` for the AVR, in its own language.
;
; Means the same as `number.cpp`, which is for all other chips. What the compiler makes of that
; takes twice as much flash and as long again: it knows no flag for an overflow, and no short way
; to a product or a quotient of more than 32 bits.
;
; Calls from C++ are those of avr-gcc: arguments from r25 down, a result in r22-r25; r2-r17, r28 and
; r29 are saved by whoever uses them, and r1 is 0. Those functions bear the names that C++ gives
; them. What lies in `wide_avr.S` may be far: a linker that relaxes makes its calls short.

#include "build.h"

#ifdef tiniscript_in_assembly

#include "bytecode_avr.S"
#include "wide_avr.h"

#if tini_fault_overflow != 1
#error "random_between returns a carry"
#endif

    .section .text.tiniscript_number, "ax", @progbits

.macro function name
    .global \name
    .type \name, @function
\name:
.endm

; For `execute_avr.S`: a is what comes of b and a. A carry says that it is out of range. X, Z, b and
; what products need are lost. T is the sign of what comes out.

.macro operation name
    .global \name
\name:
.endm

operation fixed_multiply
    rcall take_signs
    call multiply
    call divide_by_1000
    rjmp finish

; a is not 0.
operation fixed_divide
    rcall take_signs
    push a0
    push a1
    push a2
    push a3
    movw a0, b0
    movw a2, b2
    rcall let_b_be_1000
    call multiply
    pop a3
    pop a2
    pop a1
    pop a0
    call divide_and_round
    rjmp finish

; a is not 0. What is left of b, with the sign of a.
operation fixed_modulo
    push a3
    rcall take_signs
    rcall widen
    call divide
    movw b0, high0
    movw b2, high2
    brtc 1f
    call is_b_zero
    breq 1f
    call negate_b
    add b0, a0
    adc b1, a1
    adc b2, a2
    adc b3, a3
1:  pop r0
    bst r0, 7
    clc

; a is b with the sign T, if there is such a number.
finish:
    brcs 2f
    brtc 1f
    call negate_b
1:  movw a0, b0
    movw a2, b2
    bld r0, 7
    eor r0, a3
    sbrs r0, 7
    rjmp 3f
    call is_a_zero
    breq 3f
    sec
2:  ret
3:  clc
    ret

; b rounded to as many decimals as a says.
operation fixed_round
    push b0
    push b1
    push b2
    push b3
    rcall let_a_be_whole
    pop b3
    pop b2
    pop b1
    pop b0
    subi a0, -6
    sbci a1, -1
    sbci a2, -1
    sbci a3, -1
    brmi 4f                 ; below -6: half of 10^7 is more than any number
    mov r0, a1
    or r0, a2
    or r0, a3
    brne 5f
    ldi r30, 9
    sub r30, a0
    brlo 5f
    breq 5f                 ; 3 and more: it is round
    mov r0, r30
    ldi a0, 1
    ldi a1, 0
    clr a2
    clr a3
1:  movw r26, a0            ; ten times as much
    movw r30, a2
    rcall double_a
    rcall double_a
    add a0, r26
    adc a1, r27
    adc a2, r30
    adc a3, r31
    rcall double_a
    dec r0
    brne 1b
    bst b3, 7
    sbrc b3, 7
    call negate_b
    rcall widen
    call divide_and_round
    call multiply
    clc
    rjmp finish
4:  ldi b0, 0
    ldi b1, 0
    movw b2, b0
5:  movw a0, b0
    movw a2, b2
    clc
    ret

; Of both numbers: whether they differ goes to T.
take_signs:
    mov r0, a3
    eor r0, b3
    bst r0, 7
    sbrc a3, 7
    call negate_a
    sbrc b3, 7
    call negate_b
    ret

widen:
    clr high0
    clr high1
    movw high2, high0
    ret

double_a:
    lsl a0
    rol a1
    rol a2
    rol a3
    ret

; int32_t whole(int32_t a)
function _ZN10tiniscript5wholeEl
; The nearest whole number, half away from zero.
let_a_be_whole:
    bst a3, 7
    sbrc a3, 7
    call negate_a
    movw b0, a0
    movw b2, a2
    rcall widen
    call divide_by_1000
    rjmp finish

; Fault random_between(int32_t* pair, uint32_t state)
function _ZN10tiniscript14random_betweenEPlm
    push part0
    push part1
    push carry
    push r28
    push r29
    push a1                 ; the state
    push a0
    push b3
    push b2
    movw r28, r24           ; Y: the pair
    rcall load_whole
    std Y+0, a0             ; the first one
    std Y+1, a1
    std Y+2, a2
    std Y+3, a3
    adiw r28, 4
    rcall load_whole
    ld b3, -Y
    ld b2, -Y
    ld b1, -Y
    ld b0, -Y
    cp a0, b0
    cpc a1, b1
    cpc a2, b2
    cpc a3, b3
    brge 1f
    std Y+0, a0             ; the lower one
    std Y+1, a1
    std Y+2, a2
    std Y+3, a3
    movw r26, a0            ; exchanged
    movw r30, a2
    movw a0, b0
    movw a2, b2
    movw b0, r26
    movw b2, r30
1:  sub a0, b0              ; how many there are, less 1
    sbc a1, b1
    sbc a2, b2
    sbc a3, b3
    subi a0, -1
    sbci a1, -1
    sbci a2, -1
    sbci a3, -1
    pop b0
    pop b1
    pop b2
    pop b3
    rcall widen
    call divide
    ld a0, Y
    ldd a1, Y+1
    ldd a2, Y+2
    ldd a3, Y+3
    add a0, high0
    adc a1, high1
    adc a2, high2
    adc a3, high3
    bst a3, 7
    sbrc a3, 7
    call negate_a
    rcall let_b_be_1000
    call multiply
    clc
    rcall finish
    std Y+0, a0
    std Y+1, a1
    std Y+2, a2
    std Y+3, a3
    ldi r24, 0
    rol r24                 ; Fault::kOverflow is 1
    pop r29
    pop r28
products_end:
    pop carry
    pop part1
    pop part0
    ret

; uint32_t scaled(uint32_t a, uint32_t b, uint32_t divisor)
function _ZN10tiniscript6scaledEmmm
    push part0
    push part1
    push carry
    call multiply
    movw a0, r14            ; the divisor
    movw a2, r16
    call divide_and_round
    movw a0, b0
    movw a2, b2
    brcc products_end
    ldi a3, 0xff
    rjmp products_end

load_whole:
    ld a0, Y
    ldd a1, Y+1
    ldd a2, Y+2
    ldd a3, Y+3
    rjmp let_a_be_whole

let_b_be_1000:
    ldi b0, lo8(1000)
    ldi b1, hi8(1000)
    ldi b2, 0
    ldi b3, 0
    ret

; uint32_t next_random(uint32_t state)
function _ZN10tiniscript11next_randomEm
    clr b0                  ; << 13
    mov b1, a0
    mov b2, a1
    mov b3, a2
    rcall 1f
    movw b0, a2             ; >> 17
    lsr b1
    ror b0
    eor a0, b0
    eor a1, b1
    movw b0, a0             ; << 5
    movw b2, a2
1:  ldi r26, 5
2:  lsl b0
    rol b1
    rol b2
    rol b3
    dec r26
    brne 2b
    eor a0, b0
    eor a1, b1
    eor a2, b2
    eor a3, b3
    ret

#endif
