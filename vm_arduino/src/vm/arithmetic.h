// The arithmetic of `number.h` that programs do most, copied to where it is used.
//
// For all chips but the AVR, whose `number_avr.S` has all of it.

#pragma once

#include <stdint.h>

#include "number.h"
#include "small.h"

namespace tiniscript {

// The comparison of two numbers: the last three bits of EQ to GE, of IF8, IF_VAR8, UNTIL8 and so
// on.
enum class Comparator : uint8_t { kEq, kNe, kLt, kLe, kGt, kGe };

tini_always_inline Comparator comparator_of(Op op) {
  return static_cast<Comparator>(static_cast<uint8_t>(op) & 7);
}

// Whether `a` and `b` compare so. It does not branch: three bits for each comparator, the first one
// below, say whether it holds if `a` is more, equal or less.
tini_always_inline bool relates(int32_t a, Comparator comparator, int32_t b) {
  constexpr uint32_t kHolds = 2 | 5 << 3 | 4 << 6 | 6 << 9 | 1 << 12 | uint32_t{3} << 15;
  const uint8_t order = static_cast<uint8_t>((a <= b) + (a < b));
  return (kHolds >> (3 * static_cast<uint8_t>(comparator) + order) & 1) != 0;
}

tini_always_inline int32_t to_thousandths(int16_t whole) { return int32_t{whole} * kOne; }

// A sum overflows if its sign differs from the signs of both parts.
tini_always_inline Fault sum(int32_t a, int32_t b, int32_t* result) {
  const int32_t value = static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
  if (((a ^ value) & (b ^ value)) < 0) return Fault::kOverflow;
  *result = value;
  return Fault::kNone;
}

// A difference overflows if its sign is that of `b`, and `a` has the other one.
tini_always_inline Fault difference(int32_t a, int32_t b, int32_t* result) {
  const int32_t value = static_cast<int32_t>(static_cast<uint32_t>(a) - static_cast<uint32_t>(b));
  if (((a ^ b) & (a ^ value)) < 0) return Fault::kOverflow;
  *result = value;
  return Fault::kNone;
}

}  // namespace tiniscript
