// The trim of the motors: what they get for the power that a program asks for.
//
// Two cheap motors are never the same: one is stronger, both need some power before they move, and
// wires may be crossed. Knows numbers; not where they are kept, nor pins.

#ifndef TINISCRIPT_FIRMWARE_TRIM_H_
#define TINISCRIPT_FIRMWARE_TRIM_H_

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// What each output of the motor driver gets: -255 to 255.
struct Levels {
  int16_t left;
  int16_t right;
};

// Whether a trim has no bits and numbers but those that mean something.
bool is_sound(const Trim& trim);

// What the outputs get when the program asks for `left` and `right` percent, -100 to 100. `trim` is
// sound; one of zeros changes nothing.
Levels trimmed(const Trim& trim, int8_t left, int8_t right);

}  // namespace tiniscript

#endif  // TINISCRIPT_FIRMWARE_TRIM_H_
