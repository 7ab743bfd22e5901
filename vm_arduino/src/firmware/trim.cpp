#include "trim.h"

#include "../vm/small.h"

namespace tiniscript {

namespace {

uint8_t size_of(int8_t number) {
  uint8_t size = static_cast<uint8_t>(number);
  if (number < 0) size = static_cast<uint8_t>(-size);
  return size;
}

// 2.55 for each percent up to 100, in steps of 8 bits: 653 / 256.
uint8_t level_of(uint8_t percent) {
  return static_cast<uint8_t>(2 * percent + (percent * uint16_t{141} >> 8));
}

// The level of a wheel that needs the level `low` to move. It is reduced by `reduction` percent if
// that is positive.
int16_t level(int8_t power, uint8_t low, int8_t reduction) {
  if (power == 0) return 0;
  const uint8_t size = size_of(power);
  uint8_t size_level = level_of(size > 100 ? 100 : size);
  uint8_t missing = low;  // of 256 steps
  if (reduction > 0)
    missing = static_cast<uint8_t>(missing + level_of(static_cast<uint8_t>(reduction)));
  if (missing != 0) {
    const uint16_t scaled = static_cast<uint16_t>((size_level << 8) - size_level * missing);
    size_level = static_cast<uint8_t>(low + (scaled >> 8));
  }
  return power < 0 ? static_cast<int16_t>(-size_level) : size_level;
}

}  // namespace

static_assert((kExchanged | kLeftReversed | kRightReversed) == 7,
              "a sound number has no other bits");
static_assert(kMaxBalance <= 100 && kMaxLeast <= 100, "they need no limit");

tini_noinline bool is_sound(const Trim& trim) {
  return trim.wheels <= (kExchanged | kLeftReversed | kRightReversed) &&
         static_cast<uint8_t>(trim.balance + kMaxBalance) <= 2 * kMaxBalance &&
         trim.least <= kMaxLeast;
}

Levels trimmed_levels(const Trim& trim, int8_t left, int8_t right) {
  const uint8_t low = level_of(trim.least);
  Levels levels = {level(left, low, trim.balance),
                  level(right, low, static_cast<int8_t>(-trim.balance))};
  if ((trim.wheels & kLeftReversed) != 0) levels.left = static_cast<int16_t>(-levels.left);
  if ((trim.wheels & kRightReversed) != 0) levels.right = static_cast<int16_t>(-levels.right);
  if ((trim.wheels & kExchanged) != 0) levels = {levels.right, levels.left};
  return levels;
}

}  // namespace tiniscript
