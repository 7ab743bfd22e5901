// The run of a program: how it begins and ends, and the record of a fault.
//
// Knows the machine, and how button and dead-man timer affect a run. Implements the events of the
// firmware (`firmware_on_pressed` ...) and the functions of `robot.h` that are the same on every
// board.

#pragma once

#include <stdint.h>

#include "../link/messages.h"

namespace tiniscript {

// Starts an image: `live`, or `program`, which must be in memory.
void begin_run(const uint8_t* image);

// Starts the program that the button has requested, and continues the current run.
void tick_run();

// Turns the motors off first, then the actuators unless the program has reached its own end. Sets
// the robot's `state` and cancels a start by the button.
void end_run(State state, bool is_done = false);

// Ends the run and allows no start until the link does. Records `fault` if it is not 0.
void stop_run(uint8_t fault);

// Cancels a start by the button that has not happened yet.
void forget_start();

// Whether this image runs.
bool is_image_running(const uint8_t* image);

// Whether a motor is on.
bool is_driving();

}  // namespace tiniscript
