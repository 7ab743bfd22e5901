// Names of registers, and the routines that the assembly of this folder shares.

#pragma once

// two numbers
#define a0 r22
#define a1 r23
#define a2 r24
#define a3 r25
#define b0 r18
#define b1 r19
#define b2 r20
#define b3 r21

// what stands above b where a product has more than 32 bits
#define high0 r26
#define high1 r27
#define high2 r30
#define high3 r31

// what products and quotients need besides: whoever is called from C++ saves it
#define part0 r2
#define part1 r3
#define carry r12

#define negate_a tiniscript_negate_a
#define negate_b tiniscript_negate_b
#define is_a_zero tiniscript_is_a_zero
#define is_b_zero tiniscript_is_b_zero
#define multiply tiniscript_multiply
#define divide tiniscript_divide
#define divide_and_round tiniscript_divide_and_round
#define divide_by_1000 tiniscript_divide_by_1000

#define fixed_multiply tiniscript_fixed_multiply
#define fixed_divide tiniscript_fixed_divide
#define fixed_modulo tiniscript_fixed_modulo
#define fixed_round tiniscript_fixed_round
