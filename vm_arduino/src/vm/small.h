// Keeps the firmware small: one loop that copies bytes.

#pragma once

#include <stdint.h>

#include "cpu.h"

namespace tiniscript {

// Copies bytes in ascending order: `to` may overlap `from` if it lies before it. All of the
// firmware shares it; the C library's memmove would take 54 more bytes.
tini_noinline inline void copy_bytes(const void* from, uint8_t* to, uint8_t length) {
  const uint8_t* bytes = static_cast<const uint8_t*>(from);
  while (length-- != 0) *to++ = *bytes++;
}

}  // namespace tiniscript
