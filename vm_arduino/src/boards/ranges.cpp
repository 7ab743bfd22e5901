#include "../vm/number.h"
#include "analog.h"

namespace tiniscript {

int32_t analog_scaled(int32_t count, int32_t zero, int32_t step, int32_t rest) {
  const uint32_t parts = static_cast<uint32_t>(count * rest) + 511;
  // Dividing by 1023 with shifts is exact up to 2^20.
  return zero + count * step + static_cast<int32_t>((parts + (parts >> 10) + 1) >> 10);
}

int32_t in_limits(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : value > high ? high : value;
}

uint16_t map_to_range(int32_t value, int32_t low, int32_t high, uint16_t first, uint16_t last) {
  const int32_t position = in_limits(whole(value), low, high) - low;
  // Ranges above 2^15 are exact enough without their lowest bits.
  uint32_t range = static_cast<uint32_t>(high - low);
  uint32_t scaled_position = static_cast<uint32_t>(position);
  while (range > 0x7fff) {
    range >>= 1;
    scaled_position >>= 1;
  }
  const bool is_falling = last < first;
  const uint16_t span = static_cast<uint16_t>(is_falling ? first - last : last - first);
  const uint16_t part = static_cast<uint16_t>((scaled_position * span + range / 2) / range);
  return static_cast<uint16_t>(is_falling ? first - part : first + part);
}

}  // namespace tiniscript
