// For all chips but an AVR whose machine is in assembly.

#include "build.h"

#ifndef tiniscript_in_assembly

#include "number.h"

#include "arithmetic.h"

namespace tiniscript {

namespace {

struct Division {
  uint32_t quotient;
  uint32_t remainder;
};

// Magnitudes are unsigned, because -2^31 has no positive counterpart.
uint32_t magnitude(int32_t value) {
  const uint32_t bits = static_cast<uint32_t>(value);
  return value < 0 ? 0 - bits : bits;
}

// Returns a * b / divisor, or 2^32 - 1 if the quotient is larger. It is copied to where it is used:
// a divisor that is known there needs no division.
tini_always_inline Division divide_at_once(uint32_t a, uint32_t b, uint32_t divisor) {
  const uint64_t product = static_cast<uint64_t>(a) * b;
  const uint32_t low = static_cast<uint32_t>(product);
  if (low == product) return {low / divisor, low % divisor};  // quicker if it fits
  const uint64_t quotient = product / divisor;
  if (quotient > 0xffffffff) return {0xffffffff, 0};
  return {static_cast<uint32_t>(quotient), static_cast<uint32_t>(product - quotient * divisor)};
}

// A chip of 32 bits may have no product of 64 bits: then it is made of parts.
tini_always_inline uint64_t multiply(uint32_t a, uint32_t b) {
  if (kHasProduct64) return static_cast<uint64_t>(a) * b;
  const uint32_t parts[] = {(a & 0xffff) * (b & 0xffff), (a >> 16) * (b & 0xffff),
                            (a & 0xffff) * (b >> 16), (a >> 16) * (b >> 16)};
  const uint32_t middle = (parts[0] >> 16) + (parts[1] & 0xffff) + (parts[2] & 0xffff);
  const uint32_t high = parts[3] + (parts[1] >> 16) + (parts[2] >> 16) + (middle >> 16);
  return static_cast<uint64_t>(high) << 32 | (middle << 16 | (parts[0] & 0xffff));
}

// It has no quotient of 64 bits: that is made bit by bit, or 16 bits at a time if each rest has no
// more than 16, and if the chip divides at all. An ESP8266 does not.
tini_always_inline Division divide_in_parts(uint32_t a, uint32_t b, uint32_t divisor) {
  const uint64_t product = multiply(a, b);
  uint32_t low = static_cast<uint32_t>(product);
  uint32_t high = static_cast<uint32_t>(product >> 32);
  if (high == 0) return {low / divisor, low % divisor};
  if (high >= divisor) return {0xffffffff, 0};
  if (kHasQuotient32 && divisor <= 0xffff) {
    const uint32_t upper = high << 16 | low >> 16;
    const uint32_t lower = upper % divisor << 16 | (low & 0xffff);
    return {upper / divisor << 16 | lower / divisor, lower % divisor};
  }
  for (uint8_t bit = 32; bit != 0; bit--) {
    high = high << 1 | low >> 31;
    low <<= 1;
    if (high >= divisor) {
      high -= divisor;
      low++;
    }
  }
  return {low, high};
}

tini_always_inline Division divide(uint32_t a, uint32_t b, uint32_t divisor) {
  return kHasQuotient64 ? divide_at_once(a, b, divisor) : divide_in_parts(a, b, divisor);
}

// Returns a * b / divisor rounded half up, or 2^32 - 1 if that is larger.
tini_always_inline uint32_t divide_and_round(uint32_t a, uint32_t b, uint32_t divisor) {
  const Division division = divide(a, b, divisor);
  const bool is_up = division.remainder >= divisor - division.remainder;
  return division.quotient + (is_up && division.quotient != 0xffffffff ? 1 : 0);
}

// Puts a magnitude with its sign into `*result`, if it is in range.
Fault finish(uint32_t size, bool is_negative, int32_t* result) {
  *result = static_cast<int32_t>(is_negative ? 0 - size : size);
  return size == 0 || (*result < 0) == is_negative ? Fault::kNone : Fault::kOverflow;
}

// MUL, DIV, MOD
Fault scale(Op op, int32_t* pair) {
  const bool is_negative = pair[1] < 0;
  const bool signs_differ = is_negative != (pair[0] < 0);
  const uint32_t first = magnitude(pair[0]);
  const uint32_t second = magnitude(pair[1]);
  if (op == Op::kMul) return finish(divide_and_round(first, second, kOne), signs_differ, pair);
  if (second == 0) return Fault::kDivideByZero;
  if (op == Op::kDiv) return finish(divide_and_round(first, kOne, second), signs_differ, pair);
  // The exact remainder has the sign of the divisor.
  const uint32_t remainder = first % second;
  return finish(remainder != 0 && signs_differ ? second - remainder : remainder, is_negative, pair);
}

// Rounds the first of a pair to the number of decimals in the second.
Fault round(int32_t* pair) {
  const int32_t places = whole(pair[1]);
  if (places >= 3) return Fault::kNone;
  uint32_t size = 0;
  if (places >= -6) {  // half of 10^7 is more than any number
    uint32_t unit = 1;
    for (int32_t k = places; k < 3; k++) unit *= 10;
    size = divide_and_round(magnitude(pair[0]), 1, unit) * unit;
  }
  return finish(size, pair[0] < 0, pair);
}

}  // namespace

Fault calculate(Op op, int32_t* pair) {
  switch (op) {
    case Op::kAdd:
      return sum(pair[0], pair[1], pair);
    case Op::kMul:
    case Op::kDiv:
    case Op::kMod:
      return scale(op, pair);
    case Op::kRound:
      return round(pair);
    case Op::kSub:
      return difference(pair[0], pair[1], pair);
    case Op::kAbs:
      return finish(magnitude(pair[0]), false, pair);
    case Op::kNeg:
      return finish(magnitude(pair[0]), pair[0] > 0, pair);
    case Op::kMin:
      if (pair[1] < pair[0]) pair[0] = pair[1];
      return Fault::kNone;
    case Op::kMax:
      if (pair[1] > pair[0]) pair[0] = pair[1];
      return Fault::kNone;
    case Op::kAnd:
      pair[0] = pair[0] != 0 && pair[1] != 0 ? 1 : 0;
      return Fault::kNone;
    case Op::kOr:
      pair[0] = pair[0] != 0 || pair[1] != 0 ? 1 : 0;
      return Fault::kNone;
    case Op::kNot:
      pair[0] = pair[0] == 0 ? 1 : 0;
      return Fault::kNone;
    default:
      pair[0] = relates(pair[0], comparator_of(op), pair[1]) ? 1 : 0;
      return Fault::kNone;
  }
}

Fault add(int32_t* place, const int32_t* number) { return sum(*place, *number, place); }

int32_t thousandths(int16_t whole) { return to_thousandths(whole); }

bool compare(const int32_t* a, int16_t whole, uint8_t op) {
  return relates(*a, comparator_of(static_cast<Op>(op)), to_thousandths(whole));
}

int32_t whole(int32_t a) {
  const int32_t units = static_cast<int32_t>(divide_and_round(magnitude(a), 1, kOne));
  return a < 0 ? -units : units;
}

uint32_t scaled(uint32_t a, uint32_t b, uint32_t divisor) {
  return divide_and_round(a, b, divisor);
}

uint32_t next_random(uint32_t state) {
  state ^= state << 13;
  state ^= state >> 17;
  return state ^ (state << 5);
}

Fault random_between(int32_t* pair, uint32_t state) {
  const int32_t low = whole(pair[0]);
  const int32_t high = whole(pair[1]);
  const int32_t lower_bound = low < high ? low : high;
  const uint32_t count = magnitude(high - low) + 1;
  const int32_t units = lower_bound + static_cast<int32_t>(state % count);
  return finish(divide(magnitude(units), kOne, 1).quotient, units < 0, pair);
}

}  // namespace tiniscript

#endif
