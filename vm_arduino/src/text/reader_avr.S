; What the reader does most often with its code and its memory, for the AVR in its own language:
; short, since calls of these take a tenth of the reader.
;
; Means the same as `reader_portable.cpp`, and the last one as `cpu_portable.h`, which are for all other
; chips. Takes 506 bytes of flash less; without them an Uno would read no text. A chip with more flash
; in its place lets it go: then delete this file, and `reader_calls_avr.h`. `reader.h` says which
; registers these change: the reader is in Y, an argument in r24, and all others stay as they are.

#ifdef __AVR__

#include "reader_avr.h"

    .section .text.tiniscript_reader, "ax", @progbits

#define argument r24
#define short_op r25
#define number r22

.macro starts name
    .global \name
    .type \name, @function
\name:
.endm

; emit_numbered: an opcode in `argument`, the first short one in `short_op`, a number
starts tiniscript_emit_numbered
    cpi number, tini_shorts
    brcc 1f
    mov argument, short_op
    add argument, number
    rjmp tiniscript_emit
1:  rcall tiniscript_emit
    mov argument, number

; emit: a byte
starts tiniscript_emit
    ldd r25, Y + tini_code_length_at
    subi r25, -1
    breq full
    rcall room
    brcc 1f
    st X, argument
    std Y + tini_code_length_at, r25
1:  ret

; push: a byte
starts tiniscript_push
    rcall room
    brcc 2f
    st -Z, argument
1:  std Y + tini_waiting_at, r30
    std Y + tini_waiting_at + 1, r31
2:  ret

; pop: returns the byte that was pushed last
starts tiniscript_pop
    ldd r30, Y + tini_waiting_at
    ldd r31, Y + tini_waiting_at + 1
    ld argument, Z+
    rjmp 1b

; has_room: how many bytes more, in r25 and r24; returns 1 or 0 in r24
starts tiniscript_has_room
    movw r26, argument
    rcall room_after
    clr argument
    rol argument
    ret

; Sets the carry if a byte fits behind the code, and as many as X says. X is its place then, and Z
; what waits. Else that is the problem.
room:
    clr r26
    clr r27
room_after:
    ldd r30, Y + tini_code_length_at
    add r26, r30
    adc r27, r1
    ldd r30, Y + tini_buffer_at
    ldd r31, Y + tini_buffer_at + 1
    add r26, r30
    adc r27, r31
    ldd r30, Y + tini_waiting_at
    ldd r31, Y + tini_waiting_at + 1
    cp r26, r30
    cpc r27, r31
    brcs 1f
full:
    ldi r30, tini_problem_full
    std Y + tini_problem_at, r30
1:  ret

; resolve: the place of an operand
1:  ldd r30, Y + tini_buffer_at
    ldd r31, Y + tini_buffer_at + 1
    add r30, argument
    adc r31, r1
    ld r25, Z
    com argument            ; less itself, less 1
    ldd r26, Y + tini_code_length_at
    add argument, r26
    st Z, argument
    mov argument, r25
starts tiniscript_resolve
    tst argument
    brne 1b
    ret

; matches: whether the word behind the code is the one in Z, which goes behind it. `argument` says
; whether that one is in flash, and becomes the answer.
starts tiniscript_matches
    ldd r26, Y + tini_buffer_at
    ldd r27, Y + tini_buffer_at + 1
    ldd r25, Y + tini_code_length_at
    add r26, r25
    adc r27, r1
    ldi r25, 1
1:  lpm r0, Z
    sbrs argument, 0
    ld r0, Z
    adiw r30, 1
    ld r18, X+
    cpse r18, r0
    clr r25
    sbrs r0, 7              ; the last letter
    rjmp 1b
    mov argument, r25
    ret

#define minus r22
#define places r23
#define bytes r23
#define value0 r18
#define value1 r19
#define value2 r20
#define value3 r21

; The number, less 1 behind a minus, which reaches one further.
.macro size_of_number
    movw r24, value0
    sub r24, minus
    sbc r25, r1
.endm

; emit_number: 1 behind a minus, else 0
starts tiniscript_emit_number
    ldi places, 3
    rcall load_value
1:  movw r26, value0
    movw r30, value2
    rcall tiniscript_cut_digit
    brne 2f
    dec places
    brne 1b
    rjmp 3f
2:  movw value0, r26
    movw value2, r30
3:  cp value2, r1
    cpc value3, r1
    brne milli
    tst places
    brne decimals
    tst minus
    breq whole
    cpi value0, 13
    cpc value1, r1
    brcc whole_16
    ldi r24, 10
    mul value0, r24
    mov value0, r0
    clr r1
    rjmp tenths
whole:
    tst value1
    brne whole_16
    mov r24, value0         ; ones
    clr r25                 ; tens
4:  cpi r24, 11
    brcs 5f
    subi r24, 10
    inc r25
    rjmp 4b
5:  tst r25
    breq 6f
    cpi r24, 10
    brne whole_8
    cpi r25, 10
    brcc whole_8
6:  add r24, r25
    subi r24, -tini_push_num_0
    rjmp tiniscript_emit
whole_8:
    ldi r24, tini_push_8
    rjmp one
whole_16:
    size_of_number
    brmi milli
    ldi r24, tini_push_16
    rjmp two
decimals:
    dec places
    brne milli
    size_of_number
    cpi r24, 128
    cpc r25, r1
    brcc milli
tenths:
    ldi r24, tini_push_tenths
one:
    ldi bytes, 1
    rjmp send
milli:
    rcall load_value
    size_of_number
    brmi 7f
    cp value2, r1
    cpc value3, r1
    ldi r24, tini_push_milli
    breq two
7:  ldi r24, tini_push_32
    ldi bytes, 4
    rjmp send
two:
    ldi bytes, 2
send:
    sbrs minus, 0
    rjmp 8f
    com value3
    com value2
    com value1
    neg value0
    sbci value1, -1
    sbci value2, -1
    sbci value3, -1
8:  rcall tiniscript_emit
    mov r24, value0
    mov value0, value1
    mov value1, value2
    mov value2, value3
    dec bytes
    brpl 8b
    ret

load_value:
    ldd value0, Y + tini_value_at
    ldd value1, Y + tini_value_at + 1
    ldd value2, Y + tini_value_at + 2
    ldd value3, Y + tini_value_at + 3
    ret

; cut_digit: the value becomes a tenth, r24 what remains. Z is set if that is nothing.
starts tiniscript_cut_digit
    clr r24
    ldi r25, 32
1:  lsl value0
    rol value1
    rol value2
    rol value3
    rol r24
    cpi r24, 10
    brcs 2f
    subi r24, 10
    inc value0
2:  dec r25
    brne 1b
    tst r24
    ret

#endif
