#include "pace.h"

#include "../robot.h"
#include "board.h"

namespace tiniscript {

bool is_sound(const Pace& pace) {
  for (const Pace::Line& line : pace.lines) {
    if (line.at40 != 0 && line.at80 <= line.at40) return false;
  }
  return true;
}

// The line through the speeds measured at 40 and at 80 %, times 1000.
int32_t robot_speed(bool is_turn, uint8_t power) {
  const Pace& pace = port_tuning().pace;
  const Pace::Line& line = is_turn ? pace.lines[1] : pace.lines[0];
  if (line.at80 <= line.at40) {  // not measured, or not sound
    return static_cast<int32_t>(board_speed(is_turn) * power);
  }
  const int16_t weight = static_cast<int16_t>(25 * power - 1000);
  return int32_t{line.at80} * weight + int32_t{line.at40} * (1000 - weight);
}

}  // namespace tiniscript
