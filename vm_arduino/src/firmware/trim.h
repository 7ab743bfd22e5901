// The trim of the motors: converts a program's power to driver levels.
//
// Two cheap motors always differ: one is stronger, both need some power before they move, and wires
// may be crossed. Does only arithmetic: no storage, no pins.

#pragma once

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// The level of each output of the motor driver: -255 to 255.
struct Levels {
  int16_t left;
  int16_t right;
};

// Whether all bits and numbers of a trim are valid.
bool is_sound(const Trim& trim);

// The levels for `left` and `right` percent, -100 to 100. `trim` must be valid; one of zeros has no
// effect.
Levels trimmed_levels(const Trim& trim, int8_t left, int8_t right);

}  // namespace tiniscript
