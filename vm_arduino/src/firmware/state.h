// The shared state of the firmware's parts, defined in `firmware.cpp`.

#pragma once

#include <stdint.h>

#include "../link/link.h"
#include "../link/links.h"
#include "../store/nvm.h"
#include "../store/store.h"
#include "board.h"

namespace tiniscript {

// One for each transport, or one.
typedef Choice<kHasTransports, Links, Link>::Type RobotLink;

extern RobotStatus robot_status;  // the robot's state and program, and its last fault
extern uint32_t now_ms;           // of this tick
extern RobotLink link;
extern Store store;

void begin_link(uint8_t epoch);

inline bool is_running() { return robot_status.state == State::kRunning; }

// Whether there is a program that the button may start.
inline bool holds_program() {
  return robot_status.saved != Saved::kNothing && robot_status.saved != Saved::kOtherVersion &&
         (!kWritesStopTheChip || robot_status.saved != Saved::kUnreadable);
}

}  // namespace tiniscript
