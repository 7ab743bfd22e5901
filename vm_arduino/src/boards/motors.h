// The motors: the latch that stops them, and the types of motor drivers.
//
// Only `board_motors` turns a motor on, and only while the latch is open. The latch is closed after
// a reset.

#pragma once

#include <stdint.h>

#include "chip.h"

namespace tiniscript {

// Two direction pins and one PWM pin: L298N, L293D, TB6612. A pin for backward may be missing.
struct Bridge {
  Pwm pwm;
  Pin forward;
  Pin backward;
};

// Two PWM pins, one for each direction.
struct TwoWire {
  Pwm forward;
  Pwm backward;
};

// The motors of a side on a shield with a shift register: their PWM pins, and the bits of the
// register that turn them forward and backward. The second PWM pin may be missing.
struct ShieldMotors {
  Pwm pwm;
  Pwm second;
  uint8_t forward;
  uint8_t backward;
};

// A 74HC595 as it is wired. Its outputs are on while `enable` is low.
struct ShiftRegister {
  Pin latch;
  Pin enable;
  Pin data;
  Pin clock;
};

// A continuous-rotation servo; it stands still at `still_us`.
struct TurningServo {
  uint8_t number;  // index of the servo
  uint16_t still_us;
  bool is_reversed;
};

// Turns the motors off at once and closes the latch. May be called from an interrupt.
void motors_stop();

// Opens the latch: a program may drive.
void motors_release();

bool motors_are_stopped();

}  // namespace tiniscript
