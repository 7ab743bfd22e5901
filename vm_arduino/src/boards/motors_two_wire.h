// Motors behind a driver with two inputs each, such as a DRV8833 or an L9110. Off: both low.

#ifndef TINISCRIPT_BOARDS_MOTORS_TWO_WIRE_H_
#define TINISCRIPT_BOARDS_MOTORS_TWO_WIRE_H_

#include "kit.h"

namespace tiniscript {

tini_always_inline void begin_motors() {
  begin_output(kLeftMotor.forward.pin, false);
  begin_output(kLeftMotor.backward.pin, false);
  begin_output(kRightMotor.forward.pin, false);
  begin_output(kRightMotor.backward.pin, false);
}

tini_always_inline void off(TwoWire motor) {
  disconnect(motor.forward);
  disconnect(motor.backward);
}

tini_always_inline void motors_off() {
  off(kLeftMotor);
  off(kRightMotor);
}

tini_always_inline void drive(TwoWire motor, bool is_backward, uint8_t level) {
  if (is_backward) {
    disconnect(motor.forward);
    connect(motor.backward, level);
  } else {
    disconnect(motor.backward);
    connect(motor.forward, level);
  }
}

tini_always_inline void begin_drive() {}

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_MOTORS_TWO_WIRE_H_
