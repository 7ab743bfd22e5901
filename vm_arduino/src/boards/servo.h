// Servos on any pins: timer 1 makes a pulse for each in turn, 50 times a second.

#ifndef TINISCRIPT_BOARDS_SERVO_H_
#define TINISCRIPT_BOARDS_SERVO_H_

#include <stdint.h>

namespace tiniscript {

// No servo gets a pulse before it is set.
void servo_begin();

// The pulse of a servo from now on, in microseconds; for so many pulses, or without end where
// `frames` is 0. May be called in an interrupt.
void servo_set(uint8_t number, uint16_t pulse_us, uint8_t frames);

// No pulses, and the one that is under way ends: for an interrupt behind which no other comes.
void servos_low();

// Whether a servo has a pulse without end.
bool servo_is_held(uint8_t number);

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_SERVO_H_
