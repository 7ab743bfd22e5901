// Servos on any pins: timer 1 makes one pulse per servo in turn, 50 times a second.

#ifndef TINISCRIPT_BOARDS_SERVO_H_
#define TINISCRIPT_BOARDS_SERVO_H_

#include <stdint.h>

namespace tiniscript {

// A servo gets no pulse until it is set.
void servo_begin();

// Sets a servo's pulse in microseconds, for `frames` pulses or without end if `frames` is 0. May be
// called from an interrupt.
void servo_set(uint8_t number, uint16_t pulse_us, uint8_t frames);

// Ends all pulses, also the one under way. For an interrupt after which no other one runs.
void servos_low();

// Whether a servo gets pulses without end.
bool servo_is_held(uint8_t number);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_SERVO_H_
