// The clock: that of the Arduino core.

#pragma once

#include <Arduino.h>
#include <stdint.h>

namespace tiniscript {

inline uint32_t clock_ms() { return static_cast<uint32_t>(millis()); }
inline uint8_t clock_8_ms() { return static_cast<uint8_t>(millis()); }

// Microseconds; they wrap around after 65 ms.
inline uint16_t clock_us() { return static_cast<uint16_t>(micros()); }

}  // namespace tiniscript
