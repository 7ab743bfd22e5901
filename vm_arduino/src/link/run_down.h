// Times that are left, in milliseconds: they run down to 0.

#pragma once

#include <stdint.h>

#include "../vm/small.h"

namespace tiniscript {

// Takes what has passed off all of them.
tini_noinline inline void run_down(uint16_t* left_ms, uint8_t times, uint16_t passed_ms) {
  do {
    *left_ms = passed_ms < *left_ms ? static_cast<uint16_t>(*left_ms - passed_ms) : 0;
    left_ms++;
  } while (--times != 0);
}

}  // namespace tiniscript
