// HC-SR04: how far away something is, without waiting for the echo.

#ifndef TINISCRIPT_BOARDS_ECHO_H_
#define TINISCRIPT_BOARDS_ECHO_H_

#include <stdint.h>

#include "pins.h"

namespace tiniscript {

// A sensor. Group 0 to 2 are interrupts for changes of pins, 3 the external ones; `interrupt` is
// the bit in the group's mask.
struct Echo {
  Pin trigger;
  Pin echo;
  uint8_t group;
  uint8_t interrupt;
};

// Puts thousandths of a centimetre into `*distance` and returns true where there is an echo, or
// none within 25 ms: then it is 400 cm, the end of its range. Otherwise false: ask again.
bool echo_read(Echo sensor, int32_t* distance);

// A measurement that is under way is nobody's any more.
void echo_forget();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_ECHO_H_
