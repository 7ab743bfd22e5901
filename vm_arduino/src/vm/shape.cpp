#include "shape.h"

namespace tiniscript {

__attribute__((noinline)) Row row_of(uint8_t code) {
  if (code >= kFamilies) {
    if (code % 8 >= kFamilyOps) code = 0xff;
    code = static_cast<uint8_t>(kFamilies - kFamilies / 8 + code / 8);
  }
  uint8_t effects;
  uint8_t many;
  for (const uint8_t* row = kOpRows;;) {
    effects = flash_byte(row++);
    many = flash_byte(row++);
    const uint8_t more = many / 16;
    if (code <= more) break;
    code = static_cast<uint8_t>(code - more - 1);
  }
  const uint8_t bytes = flash_byte(kOperands + many % 16);
  return {effects, static_cast<uint8_t>(bytes | code % 2)};
}

}  // namespace tiniscript
