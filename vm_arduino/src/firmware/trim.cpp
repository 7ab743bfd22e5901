#include "trim.h"

#include "../vm/small.h"

namespace tiniscript {

namespace {

uint8_t size_of(int8_t number) { return static_cast<uint8_t>(number < 0 ? -number : number); }

// 2.55 for each percent.
uint8_t level_of(uint8_t percent) {
  if (percent > 100) percent = 100;
  return static_cast<uint8_t>(percent * 653u >> 8);
}

// The level of a wheel that needs `least` percent to move. It is reduced by `weakened` percent if
// that is positive.
int16_t level(int8_t power, uint8_t least, int8_t weakened) {
  if (power == 0) return 0;
  uint8_t found = level_of(size_of(power));
  uint8_t missing = level_of(least);  // of 256 steps
  const uint8_t low = missing;
  if (weakened > 0) missing = static_cast<uint8_t>(missing + level_of(size_of(weakened)));
  if (missing != 0) {
    found = static_cast<uint8_t>(low + (found * static_cast<uint16_t>(256 - missing) >> 8));
  }
  return power < 0 ? static_cast<int16_t>(-found) : found;
}

}  // namespace

static_assert((kExchanged | kLeftReversed | kRightReversed) == 7, "a sound number has no other bits");

tini_noinline bool is_sound(const Trim& trim) {
  return trim.wheels <= (kExchanged | kLeftReversed | kRightReversed) &&
         static_cast<uint8_t>(trim.balance + kMostBalance) <= 2 * kMostBalance &&
         trim.least <= kMostLeast;
}

Levels trimmed(const Trim& trim, int8_t left, int8_t right) {
  Levels found = {level(left, trim.least, trim.balance),
                  level(right, trim.least, static_cast<int8_t>(-trim.balance))};
  if ((trim.wheels & kLeftReversed) != 0) found.left = static_cast<int16_t>(-found.left);
  if ((trim.wheels & kRightReversed) != 0) found.right = static_cast<int16_t>(-found.right);
  if ((trim.wheels & kExchanged) != 0) found = {found.right, found.left};
  return found;
}

}  // namespace tiniscript
