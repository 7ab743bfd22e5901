// The readings of a remote control that programs get, after the sensors of their kit.
//
// The newest word counts: that of the driving session or, without one, of any that may press keys.
// All is let go 0.5 s after it, and at a start.

#pragma once

#include <stdint.h>

namespace tiniscript {

// KEY_UP, KEY_DOWN, KEY_LEFT, KEY_RIGHT, KEY_A, KEY_B, PAD_X, PAD_Y.
constexpr uint8_t kRemoteReadings = 8;

// One of them: a key is 0 or 1, a way of the pad in thousandths from -100 to 100.
int32_t remote_reading(uint8_t number);

}  // namespace tiniscript
