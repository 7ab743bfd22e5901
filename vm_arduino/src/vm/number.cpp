#include "number.h"

namespace tiniscript {

namespace {

// What a comparison with 0 says, from the highest byte alone: for the AVR that is four times
// shorter.
bool negative(int32_t value) { return static_cast<int8_t>(value >> 24) < 0; }

// -2^31 has a magnitude of its own: so magnitudes are unsigned.
__attribute__((noinline)) uint32_t magnitude(int32_t value) {
  const uint32_t bits = static_cast<uint32_t>(value);
  return value < 0 ? 0 - bits : bits;
}

// Returns a * b / divisor, rounded half up, of magnitudes up to 2^31; 2^32 - 1 where it is more.
// The product and then the quotient are built bit by bit in `high` and `a`: no sum has a carry,
// and 32 bits are enough.
uint32_t scaled(uint32_t a, uint32_t b, uint32_t divisor) {
  uint32_t high = 0;
  for (uint8_t bit = 32; bit != 0; bit--) {
    if ((a & 1) != 0) high += b;
    a >>= 1;
    if ((high & 1) != 0) a |= 0x80000000;
    high >>= 1;
  }
  if (high >= divisor) return 0xffffffff;
  for (uint8_t bit = 32; bit != 0; bit--) {
    high <<= 1;
    if ((a & 0x80000000) != 0) high++;
    a <<= 1;
    if (high >= divisor) {
      high -= divisor;
      a++;
    }
  }
  if (high >= divisor - high && a != 0xffffffff) a++;
  return a;
}

// Rounds a magnitude to `places` decimals.
uint32_t rounded(uint32_t size, int32_t places) {
  if (places >= 3) return size;
  if (places < -6) return 0;  // half of 10^7 is more than any number
  uint32_t unit = 1;
  for (int8_t k = static_cast<int8_t>(places); k < 3; k++) unit *= 10;
  size += unit / 2;
  return size - size % unit;
}

}  // namespace

// a - b is ~(~a + b); a sum leaves the range where its sign is that of neither part.
Fault sum(int32_t a, int32_t b, bool is_sub, int32_t* result) {
  if (is_sub) a = ~a;
  const int32_t value = static_cast<int32_t>(static_cast<uint32_t>(a) + static_cast<uint32_t>(b));
  if (negative((a ^ value) & (b ^ value))) return Fault::kOverflow;
  *result = is_sub ? ~value : value;
  return Fault::kNone;
}

Fault calculate(Op op, int32_t* pair) {
  int32_t a = pair[0];
  int32_t b = pair[1];  // NOT, NEG and ABS have none: it may lie behind the stack
  if (op == Op::kNeg || op == Op::kAbs) {
    if (op == Op::kAbs && a >= 0) return Fault::kNone;
    b = a;
    a = 0;
    op = Op::kSub;
  }
  if (op < Op::kMul) return sum(a, b, op == Op::kSub, pair);
  if (op >= Op::kEq) {
    if (op == Op::kAnd) {
      a &= b;
    } else if (op == Op::kOr) {
      a |= b;
    } else {
      if (op == Op::kNot) {
        b = 0;
        op = Op::kEq;
      }
      a = compare(a, b, static_cast<uint8_t>(op));
    }
  } else if (op == Op::kMin || op == Op::kMax) {
    if ((a < b) != (op == Op::kMin)) a = b;
  } else {
    bool is_negative = negative(a);
    uint32_t size = magnitude(a);
    if (op == Op::kRound) {
      size = rounded(size, whole(b));
    } else {
      const bool differ = is_negative != negative(b);
      uint32_t factor = magnitude(b);
      uint32_t divisor = kOne;
      if (op != Op::kMul) {
        if (factor == 0) return Fault::kDivideByZero;
        divisor = factor;
        factor = kOne;
      }
      is_negative = differ;
      if (op == Op::kMod) {
        // the exact remainder; it takes the sign of the divisor
        size %= divisor;
        if (size != 0 && differ) size = divisor - size;
        is_negative = negative(b);
      } else {
        size = scaled(size, factor, divisor);
      }
    }
    a = static_cast<int32_t>(is_negative ? 0 - size : size);
    if (a != 0 && negative(a) != is_negative) return Fault::kOverflow;
  }
  *pair = a;
  return Fault::kNone;
}

__attribute__((noinline)) bool compare(int32_t a, int32_t b, uint8_t op) {
  const uint8_t comparator = op & 7;
  const bool is_opposite = (comparator & 1) != 0;  // NE of EQ, GE of LT, LE of GT
  bool is = a < b;
  if (comparator < 2) is = a == b;
  if (comparator == 3 || comparator == 4) is = a > b;
  return is != is_opposite;
}

int32_t whole(int32_t a) {
  const int32_t units = static_cast<int32_t>((magnitude(a) + kOne / 2) / kOne);
  return negative(a) ? -units : units;
}

int16_t limited(int32_t value, int16_t low, int16_t high) {
  return value < low ? low : value > high ? high : static_cast<int16_t>(value);
}

uint32_t next_random(uint32_t state) {
  state ^= state << 13;
  state ^= state >> 17;
  return state ^ (state << 5);
}

Fault random_between(int32_t low, int32_t high, uint32_t state, int32_t* result) {
  int32_t first = whole(low);
  int32_t count = whole(high) - first;
  if (count < 0) {
    first += count;
    count = -count;
  }
  first += static_cast<int32_t>(state % (static_cast<uint32_t>(count) + 1));
  const uint32_t most = 0x7fffffff / kOne;
  if (magnitude(first) > most) return Fault::kOverflow;
  *result = first * kOne;
  return Fault::kNone;
}

}  // namespace tiniscript
