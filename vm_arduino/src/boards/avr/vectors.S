; The vectors of an ATmega328P, and its start: `order.ld` takes them in the place of the C library's.
;
; That has all 26 vectors, and a way out of main. Here are those that some robot uses, counted from 0.
; One that this robot does not use leads to 0, and so to its start, as in the C library. `order.ld` lets
; tables lie where the others would be, whose interrupts no code turns on: the linker refuses a
; function for one of them.
;
; Where another linker script places the sketch, nothing refers to these sections: they are left out.

#ifdef __AVR_ATmega328P__

#include <avr/io.h>

; As data, since the linker would shorten a jump to a near place, and move the next ones.
.macro jump_to name
    .word 0x940c                /* jmp */
    .word pm(\name)
.endm

.macro vector number
    .weak __vector_\number
    jump_to __vector_\number
.endm

    .section .lowtext.vectors_0, "ax", @progbits
    jump_to tiniscript_begin
    vector 1                    ; INT0
    vector 2                    ; INT1
    vector 3                    ; PCINT0
    vector 4                    ; PCINT1
    vector 5                    ; PCINT2
    vector 6                    ; WDT
    vector 7                    ; TIMER2_COMPA

    .section .lowtext.vectors_11, "ax", @progbits
    vector 11                   ; TIMER1_COMPA

    .section .lowtext.vectors_14, "ax", @progbits
    vector 14                   ; TIMER0_COMPA
    vector 15                   ; TIMER0_COMPB
    vector 16                   ; TIMER0_OVF

    .section .lowtext.vectors_18, "ax", @progbits
    vector 18                   ; USART_RX
    vector 19                   ; USART_UDRE

; What the sections .init3 and .init4 rely on. They follow.
    .section .lowtext.begin, "ax", @progbits
    .global tiniscript_begin
tiniscript_begin:
    clr r1
    out _SFR_IO_ADDR(SREG), r1
    ldi r28, lo8(RAMEND)
    ldi r29, hi8(RAMEND)
    out _SFR_IO_ADDR(SPH), r29
    out _SFR_IO_ADDR(SPL), r28

; Behind them. main does not return.
    .section .lowtext.begin_main, "ax", @progbits
    jmp main

#endif
