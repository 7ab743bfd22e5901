// HC-SR04: how far away something is, without waiting for the echo.
//
// A ping leaves at least 30 ms after the last one, of any sensor: what comes back later than its
// own time is nobody's echo. A reading is used for 60 ms from its ping on.

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
// none within 25 ms: then it is 400 cm, the end of its range. Otherwise false: ask again. While no
// ping may leave, the last reading is given again if it is fresh. The robot's header says how each `number` is wired.
bool echo_read(uint8_t number, int32_t* distance);

// Readings, and a measurement that is under way, are nobody's any more.
void echo_forget();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_ECHO_H_
