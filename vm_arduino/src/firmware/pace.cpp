#include "pace.h"

#include "../robot.h"
#include "../store/layout.h"
#include "board.h"

namespace tiniscript {

#ifdef tiniscript_has_pace

namespace {

Pace pace;

static_assert(sizeof pace == kPaceBytes, "it is kept as it is sent");

}  // namespace

bool is_sound(const Pace& found) {
  for (const Pace::Line& line : found.lines) {
    if (line.at80 <= line.at40 && line.at80 + line.at40 != 0) return false;
  }
  return true;
}

bool change_pace(const Pace& found) {
  bool is_other = false;
  for (uint8_t k = 0; k < 2; k++) {
    if (found.lines[k].at40 != pace.lines[k].at40) is_other = true;
    if (found.lines[k].at80 != pace.lines[k].at80) is_other = true;
  }
  pace = found;
  return is_other;
}

const Pace& port_pace() { return pace; }

// The line through what was measured at 40 and at 80 %, times 40, in hundredths.
uint32_t robot_speed(bool is_turn, uint8_t power) {
  const Pace::Line& line = pace.lines[is_turn];
  if (line.at80 == 0) return board_speed(is_turn) * power;
  const int32_t found = (80 - power) * int32_t{line.at40} + (power - 40) * int32_t{line.at80};
  return found < 0 ? 0 : static_cast<uint32_t>(found) * 25;
}

#else

uint32_t robot_speed(bool is_turn, uint8_t power) { return board_speed(is_turn) * power; }

#endif

}  // namespace tiniscript
