#include "shape.h"

namespace tiniscript {

__attribute__((noinline)) Shape shape_of(uint8_t code) {
  uint8_t entry = 0;
  if (code < kFamilies) {
    entry = flash_byte(kFormOf + code);
  } else if (code < kFamiliesEnd && code % 8 < kFamilyOps) {
    entry = static_cast<uint8_t>(kFarForms - kFamilies / 8 + code / 8);
  }
  uint8_t form = entry & kFormMask;
  uint8_t longer = 0;
  if (code < kFamilies && form >= kFarForms) {
    form = static_cast<uint8_t>(form - (kFarForms - kNearForms));
    longer = 1;
  }
  const uint8_t effects = static_cast<uint8_t>((entry & ~kFormMask) | flash_byte(kForms[form]));
  return {effects, static_cast<uint8_t>(flash_byte(kForms[form] + 1) + longer)};
}

}  // namespace tiniscript
