// The numbers of TiniScript: signed 32-bit counts of thousandths.
//
// Knows arithmetic, its rounding and its faults; means the same as `fixed_point.py`. Every argument
// and result is a count of thousandths unless a name says otherwise. If a function returns a fault,
// its result means nothing. `number_avr.S` is all of this for the AVR.

#pragma once

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

constexpr int16_t kOne = 1000;

// Calculates ADD to ROUND and EQ to OR of two adjacent values; NEG, ABS and NOT take only the first
// and may overwrite the second. The result replaces the first.
Fault calculate(Op op, int32_t* pair);

// Adds a number to the one at `place`.
Fault add(int32_t* place, const int32_t* number);

// Converts a whole number to thousandths.
int32_t thousandths(int16_t whole);

// Whether a number compares to a whole number as the last three bits of an opcode say: EQ, NE, LT,
// LE, GT, GE.
bool compare(const int32_t* a, int16_t whole, uint8_t op);

// The nearest whole number (not thousandths), half away from zero: -2147484 to 2147484.
int32_t whole(int32_t a);

// xorshift32, shifts 13, 17, 5 (Marsaglia 2003): the state is never 0.
uint32_t next_random(uint32_t state);

// Returns a * b / divisor, rounded half up, or 2^31 and more where it has no room for it. `divisor`
// is not 0, and at most 2^31.
uint32_t scaled(uint32_t a, uint32_t b, uint32_t divisor);

// Replaces the first of a pair by a random whole number between the two, both included. `state`
// must have just been stepped.
Fault random_between(int32_t* pair, uint32_t state);

}  // namespace tiniscript
