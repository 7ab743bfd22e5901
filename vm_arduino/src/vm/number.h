// The numbers of TiniScript: signed 32-bit counts of thousandths.
//
// Knows arithmetic, its rounding and its faults; means the same as `thousandths.py`. Every
// argument and result is a count of thousandths unless a name says otherwise. Where a function
// returns a fault, its result means nothing.

#ifndef TINISCRIPT_VM_NUMBER_H_
#define TINISCRIPT_VM_NUMBER_H_

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

constexpr int16_t kOne = 1000;

// Calculates ADD to ROUND and EQ to OR of two values that lie side by side; NEG, ABS and NOT take
// the first one alone. The result takes the place of the first.
Fault calculate(Op op, int32_t* pair);

// a + b, or a - b.
Fault sum(int32_t a, int32_t b, bool is_sub, int32_t* result);

// Whether `a` and `b` compare as the last three bits of an opcode say: EQ, NE, LT, LE, GT, GE.
bool compare(int32_t a, int32_t b, uint8_t op);

// The nearest whole number (not thousandths), half away from zero: -2147484 to 2147484.
int32_t whole(int32_t a);

// The number nearest to `value` from `low` to `high`.
int16_t limited(int32_t value, int16_t low, int16_t high);

// xorshift32, shifts 13, 17, 5 (Marsaglia 2003): the state is never 0.
uint32_t next_random(uint32_t state);

// A whole number from `low` to `high`, for a `state` that has just been stepped.
Fault random_between(int32_t low, int32_t high, uint32_t state, int32_t* result);

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_NUMBER_H_
