// How long the start button is down, and what a long press means.
//
// 1 s or more starts no program; 2 s confirm a claim, or let text drive a robot with an owner; 10 s
// since the reset delete the robot's keys. A spike on the wire is no press.

#pragma once

#include <stdint.h>

namespace tiniscript {

// Passes the time.
void pass_button_hold(uint16_t passed_ms);

// The button has an edge down; it is surely down; it is up.
void begin_press();
void hold_press();
void end_press();

// Whether the press is, or was, too long to start a program.
bool is_long_press();

}  // namespace tiniscript
