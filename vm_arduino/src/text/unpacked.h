// Unpacks the texts of `texts.h`, letter by letter. Knows nothing of where they go.

#pragma once

#include "../vm/small.h"
#include "texts.h"

namespace tiniscript {

// Puts what a code stands for. Calls itself as deep as there are pairs in pairs.
template <void (*put)(uint8_t)>
tini_noinline void put_code(uint8_t code) {
  while (code < kFirstLetter) {
    const uint8_t* const pair = pair_of(code);
    put_code<put>(flash_byte(pair));
    code = flash_byte(pair + 1);
  }
  put(code);
}

// Puts the letters of a text by its number.
template <void (*put)(uint8_t)>
tini_noinline void put_text(uint8_t number) {
  constexpr uint8_t kNoHalf = 1;
  uint8_t first = kNoHalf;
  for (uint16_t index = 0;; index++) {
    uint8_t code = flash_byte(packed_texts() + index / 2);
    if ((index & 1) == 0) code = static_cast<uint8_t>(code >> 4 | code << 4);
    code &= 15;
    if (first != kNoHalf) {
      code |= first;
      first = kNoHalf;
    } else if (code < kFirstCommon) {
      first = static_cast<uint8_t>(code << 4);
      continue;
    } else {
      code = flash_byte(packed_codes() + code - kFirstCommon);
    }
    if (code != kTextEnd) {
      if (number == 0) put_code<put>(code);
    } else if (number-- == 0) {
      return;
    }
  }
}

}  // namespace tiniscript
