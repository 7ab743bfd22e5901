// For all chips but the AVR.

#ifndef __AVR__

#include "number.h"

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

// Returns a * b / divisor, or 2^32 - 1 if the quotient is larger.
#ifdef __wasm__

Division divided(uint32_t a, uint32_t b, uint32_t divisor) {
  const uint64_t product = static_cast<uint64_t>(a) * b;
  const uint32_t low = static_cast<uint32_t>(product);
  if (low == product) return {low / divisor, low % divisor};  // quicker if it fits
  const uint64_t quotient = product / divisor;
  if (quotient > 0xffffffff) return {0xffffffff, 0};
  return {static_cast<uint32_t>(quotient), static_cast<uint32_t>(product - quotient * divisor)};
}

#else

// A chip of 32 bits may have no product and has no quotient of 64: they are made of parts, and bit
// by bit where it must be.
Division divided(uint32_t a, uint32_t b, uint32_t divisor) {
  const uint32_t parts[] = {(a & 0xffff) * (b & 0xffff), (a >> 16) * (b & 0xffff),
                            (a & 0xffff) * (b >> 16), (a >> 16) * (b >> 16)};
  const uint32_t middle = (parts[0] >> 16) + (parts[1] & 0xffff) + (parts[2] & 0xffff);
  uint32_t low = middle << 16 | (parts[0] & 0xffff);
  uint32_t high = parts[3] + (parts[1] >> 16) + (parts[2] >> 16) + (middle >> 16);
  if (high == 0) return {low / divisor, low % divisor};
  if (high >= divisor) return {0xffffffff, 0};
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

#endif

// Returns a * b / divisor rounded half up, or 2^32 - 1 if that is larger.
uint32_t scaled(uint32_t a, uint32_t b, uint32_t divisor) {
  const Division division = divided(a, b, divisor);
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
  const bool differ = is_negative != (pair[0] < 0);
  const uint32_t first = magnitude(pair[0]);
  const uint32_t second = magnitude(pair[1]);
  if (op == Op::kMul) return finish(scaled(first, second, kOne), differ, pair);
  if (second == 0) return Fault::kDivideByZero;
  if (op == Op::kDiv) return finish(scaled(first, kOne, second), differ, pair);
  // The exact remainder has the sign of the divisor.
  const uint32_t rest = first % second;
  return finish(rest != 0 && differ ? second - rest : rest, is_negative, pair);
}

// Whether `a` and `b` compare as the last three bits of `op` say.
bool relates(int32_t a, int32_t b, uint8_t op) {
  const uint8_t comparator = op & 7;
  const bool is_opposite = (comparator & 1) != 0;  // NE of EQ, GE of LT, LE of GT
  bool is = a < b;
  if (comparator < 2) is = a == b;
  if (comparator == 3 || comparator == 4) is = a > b;
  return is != is_opposite;
}

// Rounds the first of a pair to the number of decimals in the second.
Fault round(int32_t* pair) {
  const int32_t places = whole(pair[1]);
  if (places >= 3) return Fault::kNone;
  uint32_t size = 0;
  if (places >= -6) {  // half of 10^7 is more than any number
    uint32_t unit = 1;
    for (int32_t k = places; k < 3; k++) unit *= 10;
    size = scaled(magnitude(pair[0]), 1, unit) * unit;
  }
  return finish(size, pair[0] < 0, pair);
}

}  // namespace

Fault calculate(Op op, int32_t* pair) {
  switch (op) {
    case Op::kAdd:
      return add(pair, pair + 1);
    case Op::kMul:
    case Op::kDiv:
    case Op::kMod:
      return scale(op, pair);
    case Op::kRound:
      return round(pair);
    case Op::kSub:
      // a - b is ~(~a + b)
      {
        pair[0] = ~pair[0];
        const Fault fault = add(pair, pair + 1);
        pair[0] = ~pair[0];
        return fault;
      }
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
      pair[0] = relates(pair[0], pair[1], static_cast<uint8_t>(op)) ? 1 : 0;
      return Fault::kNone;
  }
}

// A sum overflows if its sign differs from the signs of both parts.
Fault add(int32_t* place, const int32_t* number) {
  const int32_t value =
      static_cast<int32_t>(static_cast<uint32_t>(*place) + static_cast<uint32_t>(*number));
  if (((*place ^ value) & (*number ^ value)) < 0) return Fault::kOverflow;
  *place = value;
  return Fault::kNone;
}

int32_t thousandths(int16_t whole) { return int32_t{whole} * kOne; }

bool compare(const int32_t* a, int16_t whole, uint8_t op) {
  return relates(*a, thousandths(whole), op);
}

int32_t whole(int32_t a) {
  const int32_t units = static_cast<int32_t>(scaled(magnitude(a), 1, kOne));
  return a < 0 ? -units : units;
}

uint32_t next_random(uint32_t state) {
  state ^= state << 13;
  state ^= state >> 17;
  return state ^ (state << 5);
}

Fault random_between(int32_t* pair, uint32_t state) {
  const int32_t low = whole(pair[0]);
  const int32_t high = whole(pair[1]);
  const int32_t least = low < high ? low : high;
  const uint32_t count = magnitude(high - low) + 1;
  const int32_t units = least + static_cast<int32_t>(state % count);
  return finish(divided(magnitude(units), kOne, 1).quotient, units < 0, pair);
}

}  // namespace tiniscript

#endif
