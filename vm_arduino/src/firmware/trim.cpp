#include "trim.h"

namespace tiniscript {

namespace {

uint8_t size_of(int8_t number) { return static_cast<uint8_t>(number < 0 ? -number : number); }

// 2.55 for each percent.
uint8_t level_of(uint8_t percent) {
  if (percent > 100) percent = 100;
  return static_cast<uint8_t>(percent * 653u >> 8);
}

// What a wheel gets that needs `least` percent to move, and is `weakened` by so many percent where
// that is more than 0.
int16_t level(int8_t power, uint8_t least, int8_t weakened) {
  if (power == 0) return 0;
  const uint8_t low = level_of(least);
  uint16_t steps = static_cast<uint16_t>(256 - low);
  if (weakened > 0) steps = static_cast<uint16_t>(steps - level_of(size_of(weakened)));
  const uint8_t asked = level_of(size_of(power));
  const int16_t found = static_cast<int16_t>(low + (asked * steps >> 8));
  return power < 0 ? static_cast<int16_t>(-found) : found;
}

}  // namespace

bool is_sound(const Trim& trim) {
  return (trim.wheels & ~(kExchanged | kLeftReversed | kRightReversed)) == 0 &&
         size_of(trim.balance) <= kMostBalance && trim.least <= kMostLeast;
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
