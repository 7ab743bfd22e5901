// What `number_avr.S` and `wide_avr.S` call the registers, and the routines that they share.

#ifndef TINISCRIPT_VM_WIDE_AVR_H_
#define TINISCRIPT_VM_WIDE_AVR_H_

// two numbers and a divisor
#define a0 r22
#define a1 r23
#define a2 r24
#define a3 r25
#define b0 r18
#define b1 r19
#define b2 r20
#define b3 r21
#define d0 r14
#define d1 r15
#define d2 r16
#define d3 r17

// what stands above a where a product has more than 32 bits
#define high0 r26
#define high1 r27
#define high2 r30
#define high3 r31

#define load_magnitude tiniscript_load_magnitude
#define negate_a tiniscript_negate_a
#define load tiniscript_load
#define is_a_zero tiniscript_is_a_zero
#define negate_d tiniscript_negate_d
#define double_d tiniscript_double_d
#define let_d_be_1000 tiniscript_let_d_be_1000
#define let_b_be_1000 tiniscript_let_b_be_1000
#define widen tiniscript_widen
#define multiply tiniscript_multiply
#define divide_and_round tiniscript_divide_and_round
#define divide tiniscript_divide

#endif  // TINISCRIPT_VM_WIDE_AVR_H_
