#include "number.h"

namespace tiniscript {

namespace {

// -2^31 has a magnitude of its own: so magnitudes are unsigned.
uint32_t magnitude(int32_t value) {
  const uint32_t bits = static_cast<uint32_t>(value);
  return value < 0 ? 0 - bits : bits;
}

// Puts a magnitude and its sign together, where 32 bits hold them.
Fault in_range(uint32_t size, bool is_negative, int32_t* result) {
  const int32_t value = static_cast<int32_t>(is_negative ? 0 - size : size);
  if (value != 0 && (value < 0) != is_negative) return Fault::kOverflow;
  *result = value;
  return Fault::kNone;
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

// Makes `*value` a magnitude; returns whether it was negative.
__attribute__((noinline)) bool unsign(int32_t* value) {
  if (*value >= 0) return false;
  *value = static_cast<int32_t>(0 - static_cast<uint32_t>(*value));
  return true;
}

}  // namespace

// a - b is a + ~b + 1; a sum leaves the range where its sign is that of neither part.
Fault sum(int32_t a, int32_t b, bool is_sub, int32_t* result) {
  uint32_t bits = static_cast<uint32_t>(a);
  if (is_sub) {
    b = ~b;
    bits++;
  }
  bits += static_cast<uint32_t>(b);
  const int32_t value = static_cast<int32_t>(bits);
  if (((a ^ value) & (b ^ value)) < 0) return Fault::kOverflow;
  *result = value;
  return Fault::kNone;
}

Fault calculate(Op op, int32_t* pair) {
  // NOT, NEG and ABS leave `pair[1]` alone: it may lie behind the stack
  if (op == Op::kNot) {
    pair[0] = pair[0] == 0;
    return Fault::kNone;
  }
  if (op == Op::kAnd) {
    pair[0] &= pair[1];
    return Fault::kNone;
  }
  if (op == Op::kOr) {
    pair[0] |= pair[1];
    return Fault::kNone;
  }
  if (op >= Op::kEq) {
    pair[0] = compare(pair[0], pair[1], static_cast<uint8_t>(op));
    return Fault::kNone;
  }
  if (op < Op::kMul) return sum(pair[0], pair[1], op == Op::kSub, pair);
  if (op == Op::kMin || op == Op::kMax) {
    if ((pair[0] < pair[1]) != (op == Op::kMin)) pair[0] = pair[1];
    return Fault::kNone;
  }
  const int32_t places = op == Op::kRound ? whole(pair[1]) : 0;
  bool is_negative = unsign(pair);
  uint32_t size = static_cast<uint32_t>(pair[0]);
  if (op == Op::kRound) {
    size = rounded(size, places);
  } else if (op == Op::kNeg) {
    is_negative = !is_negative;
  } else if (op == Op::kAbs) {
    is_negative = false;
  } else {
    const bool is_other_negative = unsign(pair + 1);
    const bool differ = is_negative != is_other_negative;
    uint32_t factor = static_cast<uint32_t>(pair[1]);
    uint32_t divisor = kOne;
    if (op != Op::kMul) {
      if (factor == 0) return Fault::kDivideByZero;
      divisor = factor;
      factor = kOne;
    }
    if (op == Op::kMod) {
      // the exact remainder; it takes the sign of the divisor
      size %= divisor;
      if (size != 0 && differ) size = divisor - size;
      is_negative = is_other_negative;
    } else {
      size = scaled(size, factor, divisor);
      is_negative = differ;
    }
  }
  return in_range(size, is_negative, pair);
}

bool compare(int32_t a, int32_t b, uint8_t op) {
  const uint8_t comparator = op & 7;
  const bool is_opposite = (comparator & 1) != 0;  // NE of EQ, GE of LT, LE of GT
  bool is;
  if (comparator < 2) {
    is = a == b;
  } else if (comparator == 3 || comparator == 4) {
    is = a > b;
  } else {
    is = a < b;
  }
  return is != is_opposite;
}

int32_t whole(int32_t a) {
  const int32_t units = static_cast<int32_t>((magnitude(a) + kOne / 2) / kOne);
  return a < 0 ? -units : units;
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
  const uint32_t step = state % (static_cast<uint32_t>(count) + 1);
  int32_t pair[] = {first + static_cast<int32_t>(step), int32_t{kOne} * kOne};
  const Fault fault = calculate(Op::kMul, pair);
  *result = pair[0];
  return fault;
}

}  // namespace tiniscript
