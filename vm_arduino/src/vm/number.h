// The numbers of TiniScript: signed 32-bit counts of thousandths.
//
// Knows arithmetic, its rounding and its faults; means the same as `fixed_point.py`. Every
// argument and result is a count of thousandths unless a name says otherwise. Where a function
// returns a fault, its result means nothing. `number_avr.S` is all of this for the AVR.

#ifndef TINISCRIPT_VM_NUMBER_H_
#define TINISCRIPT_VM_NUMBER_H_

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

constexpr int16_t kOne = 1000;

// Calculates ADD to ROUND and EQ to OR of two values that lie side by side; NEG, ABS and NOT take
// the first one alone, and may write over the second. The result takes the place of the first.
Fault calculate(Op op, int32_t* pair);

// Adds a number to the one at `place`.
Fault add(int32_t* place, const int32_t* number);

// A whole number, as thousandths.
int32_t thousandths(int16_t whole);

// Whether a number compares to a whole one as the last three bits of an opcode say: EQ, NE, LT, LE,
// GT, GE.
bool compare(const int32_t* a, int16_t whole, uint8_t op);

// The nearest whole number (not thousandths), half away from zero: -2147484 to 2147484.
int32_t whole(int32_t a);

// size % divisor, of any counts; the divisor is 1 to 2^31.
uint32_t remainder(uint32_t size, uint32_t divisor);

// xorshift32, shifts 13, 17, 5 (Marsaglia 2003): the state is never 0.
uint32_t next_random(uint32_t state);

// Puts a whole number between the two of a pair, both included, into the place of the first.
// `state` has just been stepped.
Fault random_between(int32_t* pair, uint32_t state);

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_NUMBER_H_
