// The measured speed of the robot: what the numbers in its memory mean for a move.
//
// Does only arithmetic: no storage. `pace.cpp` implements `robot_speed`.

#pragma once

#include "../link/port.h"
#include "../vm/bytecode.h"

namespace tiniscript {

// Whether each line rises, or is missing.
bool is_sound(const Pace& pace);

}  // namespace tiniscript
