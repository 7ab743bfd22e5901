// What the machine may ask of the world.
//
// Plain functions: each build links one definition of them (a board, a test, a simulation).
// None of them waits. Numbers are thousandths, TRUE is 1.

#ifndef TINISCRIPT_ROBOT_H_
#define TINISCRIPT_ROBOT_H_

#include <stdint.h>

namespace tiniscript {

// Sets both motors, -100 to 100 percent.
void robot_motors(int8_t left, int8_t right);

// Motors off: the program has ended or faulted.
void robot_off();

// Puts a reading into `*value`, or returns false while it is not there yet: the machine asks again.
bool robot_read(uint8_t sensor, int32_t* value);

// Starts a sound of 31 to 20000 hertz; it ends by itself.
void robot_beep(uint16_t hertz, uint32_t duration_ms);

// Sends a value; returns false while there is no room: the machine tries again.
bool robot_show(int32_t value, bool is_yes_no);

// Sets an actuator; the robot rounds and limits the value to its range.
void robot_set(uint8_t actuator, int32_t value);

}  // namespace tiniscript

#endif  // TINISCRIPT_ROBOT_H_
