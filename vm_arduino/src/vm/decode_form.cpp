#include "decode_form.h"

namespace tiniscript {

__attribute__((noinline)) DecodeForm decode_form_of(uint8_t code) {
  uint8_t number = 0;
  if (code < kFirstSix || (code & 6) != 6) {
    if (code >= kFirstFour) code = static_cast<uint8_t>(kFirstFour / 4 * 3 + code / 4);
    number = flash_byte(kFormOf + code);
  }
  const uint8_t* const row = kForms[number];
  const uint8_t bytes = flash_byte(row + 1);
  return {flash_byte(row), bytes, flash_byte(kOperands + bytes / 32), static_cast<Family>(number)};
}

}  // namespace tiniscript
