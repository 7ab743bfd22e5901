// The motors: the latch that stops them, and what a motor is for each driver.
//
// Nothing turns a motor on but `board_motors`, and it only while the latch is open. The latch is
// closed after a reset.

#ifndef TINISCRIPT_BOARDS_MOTORS_H_
#define TINISCRIPT_BOARDS_MOTORS_H_

#include <stdint.h>

#include "pins.h"

namespace tiniscript {

// Two pins say which way and one how strongly: L298N, L293D, TB6612.
struct Bridge {
  Pwm pwm;
  Pin forward;
  Pin backward;
};

// PWM on the one wire or on the other.
struct TwoWire {
  Pwm forward;
  Pwm backward;
};

// A servo that turns without end; at `still_us` it stands.
struct TurningServo {
  uint8_t number;  // of the servos
  uint16_t still_us;
  bool is_reversed;
};

// Turns the motors off at once and closes the latch. May be called in an interrupt.
void motors_stop();

// Opens the latch: from now on a program drives.
void motors_release();

bool motors_are_stopped();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_MOTORS_H_
