; The arithmetic of `number.h` for the AVR, in its own language.
;
; Means the same as `number.cpp`, which is for all other chips. What the compiler makes of that
; takes twice as much flash and as long again: it knows no flag for an overflow, and no short way
; to a product or a quotient of more than 32 bits.
;
; Calls are those of avr-gcc: arguments from r25 down, a result in r24 or r22-r25; r2-r17, r28 and
; r29 are saved by whoever uses them, and r1 is 0. Functions bear the names that C++ gives them.
; What lies in `wide_avr.S` may be far: a linker that relaxes makes its calls short.

#ifdef __AVR__

#define FAULT_OVERFLOW 1
#define FAULT_DIVIDE_BY_ZERO 2

#define OP_MUL 0x12
#define OP_MOD 0x14
#define OP_NEG 0x15
#define OP_ABS 0x16
#define OP_MAX 0x18
#define OP_ROUND 0x19
#define OP_EQ 0x20
#define OP_NOT 0x26
#define LE 3
#define GE 5

#include "wide_avr.h"

    .section .text.tiniscript_number, "ax", @progbits

.macro function name
    .global \name
    .type \name, @function
\name:
.endm

; For `leave`.
.macro save_d_and_y
    push d0
    push d1
    push d2
    push d3
    push r28
    push r29
.endm

; Fault calculate(Op op, int32_t* pair)
function _ZN10tiniscript9calculateENS_2OpEPl
    movw r30, r22           ; Z: the pair
    movw r26, r22
    adiw r26, 4             ; X: its second number
    mov r20, r24
    cpi r20, OP_MUL
    brlo add_or_subtract
    cpi r20, OP_ROUND
    breq 1f
    brsh decide
    cpi r20, OP_NEG
    breq negate
    brsh 2f
1:  rjmp scale
2:  cpi r20, OP_ABS
    breq absolute
    cpi r20, OP_MAX         ; MIN and MAX: the first number stays if it is LE, or GE
    ldi r20, GE
    breq 1f
    ldi r20, LE
1:  rcall relate
    brne fine
    ldi r20, 4              ; the pointers have gone on to the end of the numbers
2:  ld r18, -X
    st -Z, r18
    dec r20
    brne 2b
    rjmp fine

absolute:
    call load_magnitude
    sbrc a3, 7
    rjmp overflow
    rjmp store

negate:
    call load
    call negate_a
    brvs overflow
    rjmp store

; Fault add(int32_t* place, const int32_t* number)
function _ZN10tiniscript3addEPlPKl
    movw r30, r24
    movw r26, r22
    ldi r20, 0
add_or_subtract:
    andi r20, 1
    neg r20                 ; of 1: all bits and a carry, as a - b is a + ~b + 1
    ld a0, Z
    ld r0, X+
    eor r0, r20
    adc a0, r0
    ldd a1, Z+1
    ld r0, X+
    eor r0, r20
    adc a1, r0
    ldd a2, Z+2
    ld r0, X+
    eor r0, r20
    adc a2, r0
    ldd a3, Z+3
    ld r0, X+
    eor r0, r20
    adc a3, r0
    brvs overflow
store:
    st Z, a0
    std Z+1, a1
    std Z+2, a2
    std Z+3, a3
fine:
    ldi r24, 0
    ret
overflow:
    ldi r24, FAULT_OVERFLOW
    ret


; EQ to GE, NOT, AND, OR
decide:
    cpi r20, OP_NOT
    brlo 3f
    breq 2f
    ldi r21, 4
1:  ld r18, Z
    ld r19, X+
    sbrc r20, 0             ; AND is odd, OR is even
    and r18, r19
    sbrs r20, 0
    or r18, r19
    st Z+, r18
    dec r21
    brne 1b
    rjmp fine
2:  std Z+4, r1             ; NOT: is it equal to 0?
    std Z+5, r1
    std Z+6, r1
    std Z+7, r1
    ldi r20, OP_EQ
3:  rcall relate
    sbiw r30, 4
    mov a0, r24
    ldi a1, 0
    ldi a2, 0
    ldi a3, 0
    rjmp store

; bool compare(const int32_t* a, int16_t whole, uint8_t op)
function _ZN10tiniscript7compareEPKlih
    movw r30, r24
    movw r24, r22
    rcall let_a_be_thousandths
    rjmp relate_to_a

; Returns in r24, and as "not equal", whether the number at Z relates to the one at X as the last
; three bits of r20 say: EQ, NE, LT, LE, GT, GE. Both pointers go on to the end of their numbers.
relate:
    ld a0, X+
    ld a1, X+
    ld a2, X+
    ld a3, X+
relate_to_a:
    ld r0, Z+
    cp r0, a0
    ld r0, Z+
    cpc r0, a1
    ld r0, Z+
    cpc r0, a2
    ld r0, Z+
    cpc r0, a3
    ldi r24, 1              ; equal
    breq 1f
    ldi r24, 2              ; less
    brlt 1f
    ldi r24, 4              ; more
1:  andi r20, 7             ; LT to GE are the sums of what they allow
    cpi r20, 2
    brsh 2f
    sbrc r20, 0
    ldi r20, 5              ; EQ and NE, 0 and 1, become 1 and 6
    inc r20
2:  and r24, r20
    breq 3f
    ldi r24, 1
3:  and r24, r24
    ret

; MUL, DIV, MOD, ROUND: of magnitudes; T is the sign of what comes out.
scale:
    save_d_and_y
    movw r28, r30           ; Y: the pair
    cpi r20, OP_ROUND
    breq round
    ldd d0, Y+4
    ldd d1, Y+5
    ldd d2, Y+6
    ldd d3, Y+7
    ldd r0, Y+3
    eor r0, d3
    bst r0, 7
    sbrc d3, 7
    call negate_d
    cpi r20, OP_MUL
    breq 3f
    mov r0, d0
    or r0, d1
    or r0, d2
    or r0, d3
    breq 4f
    cpi r20, OP_MOD
    breq 1f
    call load_magnitude    ; DIV: a * 1000 / |d|
    call let_b_be_1000
    rjmp 5f
1:  call load_magnitude    ; MOD: what is left of a, with the sign of the divisor
    rcall remainder_of_a
    brtc 2f
    call is_a_zero
    breq 2f
    call negate_a
    add a0, d0
    adc a1, d1
    adc a2, d2
    adc a3, d3
2:  ldd r0, Y+7
    bst r0, 7
    rjmp finish
3:  call load_magnitude    ; MUL: a * |d| / 1000
    movw b0, d0
    movw b2, d2
    call let_d_be_1000
5:  call multiply
    call divide_and_round
    rjmp finish
4:  ldi r24, FAULT_DIVIDE_BY_ZERO
    rjmp leave

round:
    adiw r30, 4
    call load
    rcall let_a_be_whole    ; the places
    subi a0, -6
    sbci a1, -1
    sbci a2, -1
    sbci a3, -1
    brmi 2f                 ; below -6: half of 10^7 is more than any number
    mov r0, a1
    or r0, a2
    or r0, a3
    brne 3f
    ldi b0, 9
    sub b0, a0
    brlo 3f
    breq 3f                 ; 3 and more: it is round
    clr d0
    inc d0
    clr d1
    clr d2
    clr d3
1:  movw r26, d0            ; ten times as much
    movw r30, d2
    call double_d
    call double_d
    add d0, r26
    adc d1, r27
    adc d2, r30
    adc d3, r31
    call double_d
    dec b0
    brne 1b
    movw r30, r28
    call load_magnitude
    ldd r0, Y+3
    bst r0, 7
    call widen
    call divide_and_round
    movw b0, d0
    movw b2, d2
    call multiply
    rjmp finish
2:  ldi a0, 0
    ldi a1, 0
    movw a2, a0
    rjmp finish
3:  ldi r24, 0
    rjmp leave

; Fault random_between(int32_t* pair, uint32_t state)
function _ZN10tiniscript14random_betweenEPlm
    save_d_and_y
    push r20                ; the state
    push r21
    push r22
    push r23
    movw r28, r24           ; Y: the pair
    movw r30, r24
    movw r26, r24
    adiw r26, 4
    ldi r20, LE
    rcall relate
    brne 2f
    ldi r20, 4              ; the other way round
1:  ld r18, -X
    ld r19, -Z
    st Z, r18
    st X, r19
    dec r20
    brne 1b
2:  movw r30, r28
    call load
    rcall let_a_be_whole
    movw r30, r28
    rcall store
    adiw r30, 4
    call load
    rcall let_a_be_whole
    ld r0, Y                ; how many there are, less 1
    sub a0, r0
    ldd r0, Y+1
    sbc a1, r0
    ldd r0, Y+2
    sbc a2, r0
    ldd r0, Y+3
    sbc a3, r0
    subi a0, -1
    sbci a1, -1
    sbci a2, -1
    sbci a3, -1
    movw d0, a0
    movw d2, a2
    pop a3
    pop a2
    pop a1
    pop a0
    rcall remainder_of_a
    ld r0, Y
    add a0, r0
    ldd r0, Y+1
    adc a1, r0
    ldd r0, Y+2
    adc a2, r0
    ldd r0, Y+3
    adc a3, r0
    bst a3, 7
    sbrc a3, 7
    call negate_a
    call let_b_be_1000
    call multiply

; Stores a with the sign T at Y, if there is such a number.
finish:
    movw r30, r28
    brtc 1f
    call negate_a
1:  bld r0, 7
    eor r0, a3
    sbrs r0, 7
    rjmp 2f
    call is_a_zero
    breq 2f
    rcall overflow
    rjmp leave
2:  rcall store
leave:
    pop r29
    pop r28
    pop d3
    pop d2
    pop d1
    pop d0
    ret

; int32_t thousandths(int16_t whole)
function _ZN10tiniscript11thousandthsEi
; Makes a of r24 and r25. Leaves r20, Z.
let_a_be_thousandths:
    movw r26, r24
    ldi r18, lo8(1000)
    ldi r19, hi8(1000)
    mul r26, r18
    movw a0, r0
    mul r27, r19
    movw a2, r0
    mul r27, r18
    add a1, r0
    adc a2, r1
    clr r1
    adc a3, r1
    mul r26, r19
    add a1, r0
    adc a2, r1
    clr r1
    adc a3, r1
    sbrs r27, 7
    ret
    sub a2, r18
    sbc a3, r19
    ret

; int32_t whole(int32_t a)
function _ZN10tiniscript5wholeEl
    save_d_and_y
    rcall let_a_be_whole
    rjmp leave

; uint32_t remainder(uint32_t size, uint32_t divisor)
function _ZN10tiniscript9remainderEmm
    save_d_and_y
    movw d0, b0
    movw d2, b2
    rcall remainder_of_a
    rjmp leave

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

; The nearest whole number, half away from zero.
let_a_be_whole:
    bst a3, 7
    sbrc a3, 7
    call negate_a
    call let_d_be_1000
    call widen
    call divide_and_round
    brtc 1f
    jmp negate_a
1:  ret

remainder_of_a:
    call widen
    call divide
    movw a0, high0
    movw a2, high2
    ret

#endif
