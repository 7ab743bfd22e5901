// A motor at two pins of a bridge such as an L298N or an L9110: one does PWM, the other says which
// way. It is for sketches alone: nothing else of this library knows a pin.

#pragma once

#include <Arduino.h>

struct TiniMotor {
  uint8_t pwm;
  uint8_t backward;

  // Makes outputs of both pins: the motor is off.
  void begin() const {
    pinMode(pwm, OUTPUT);
    pinMode(backward, OUTPUT);
    drive(0);
  }

  // Turns it, -100 to 100 percent. Backward the motor gets what PWM leaves out.
  void drive(int8_t percent) const {
    digitalWrite(backward, percent < 0 ? HIGH : LOW);
    const int duty = percent * 255 / 100;
    analogWrite(pwm, percent < 0 ? 255 + duty : duty);
  }
};
