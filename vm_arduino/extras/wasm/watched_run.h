// Holds the program of a virtual robot, so that somebody can look at it.

#pragma once

#include <stdint.h>

namespace tiniscript {

constexpr uint32_t kNowhere = 0xffffffff;

// A byte for each offset of a program's code. `watched_want` says which bits hold it.
uint8_t* watched_marks();
uint32_t watched_marks_bytes();
void watched_want(uint8_t bits);

// Whether a program has been held since `watched_begin`.
void watched_begin();
bool watched_has_held();

// The offset in front of which it is held, or kNowhere. What it does next, it does at the time at
// which it was held; only the motors know if time goes on meanwhile.
uint32_t watched_held_at();
void watched_go_on();

// Where the program's tasks are that have not ended: how many, and for each the last byte of what it
// waits in. Of a program without tasks, or while none runs: none.
const int32_t* watched_tasks();

// Where the task is that has the motors, while they are on; kNowhere of a program without tasks.
uint32_t watched_driver();

// The kVariables variables of the program that runs or has run, in thousandths.
const int32_t* watched_variables();

}  // namespace tiniscript
