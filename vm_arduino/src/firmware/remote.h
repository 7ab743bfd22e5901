// What a program reads of a remote control, after the sensors of its kit.
//
// The newest word counts: of the session that drives or, where none does, of any that may. All is let
// go 0.5 s after it, and at a start.

#pragma once

#include <stdint.h>

namespace tiniscript {

// KEY_UP, KEY_DOWN, KEY_LEFT, KEY_RIGHT, KEY_A, KEY_B, PAD_X, PAD_Y.
constexpr uint8_t kRemoteReadings = 8;

// One of them: a key is 0 or 1, a way of the pad in thousandths from -100 to 100.
int32_t remote_reading(uint8_t number);

}  // namespace tiniscript
