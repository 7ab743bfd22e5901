#include "shape.h"

namespace tiniscript {

__attribute__((noinline)) Shape shape_of(uint8_t code) {
  uint8_t row_number = 0;
  if (code >= kFamilies) {
    const uint8_t comparator = code % 8;
    code = static_cast<uint8_t>(kFamilies + (code - kFamilies) / 8);
    if (comparator >= kFamilyOps) code = kRows;
  }
  if (code < kRows) row_number = flash_byte(kRowOf + code);
  return {row_number == 0 ? nullptr : kOpRows[row_number - 1]};
}

}  // namespace tiniscript
