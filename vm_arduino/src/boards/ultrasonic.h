// HC-SR04: measures distance without waiting for the echo.
//
// Pings of all sensors are at least 30 ms apart, so that a late echo is not taken for the next one.
// A reading is valid for 60 ms from its ping on. A sample that differs much from the last value has
// to be confirmed by a second one, and a run's first value is the middle one of three. An echo that
// stays high for 0.3 s is of a sensor that hangs: it is read as 0, and pulled low for a moment where
// the pin is joined to it without a divider.

#pragma once

#include <stdint.h>

#include "chip.h"

namespace tiniscript {

struct Ultrasonic {
  Pin trigger;
  Echo echo;
};

void ultrasonic_begin();

// Puts thousandths of a centimetre into `*distance` and returns true if there is an echo; without
// one in 25 ms it is 400 cm, the end of the range. Returns false otherwise: ask again. While no
// ping may be sent, returns the last reading again if it is fresh. The robot's header says how each
// `number` is wired.
bool ultrasonic_read(uint8_t number, int32_t* distance);

// Call it at least every 30 ms: the spacing of pings is timed with a clock that wraps at 65 ms.
void ultrasonic_tick();

// Discards readings and the measurement that is under way.
void ultrasonic_forget();

}  // namespace tiniscript
