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

// The line through what was measured at 40 and at 80 %, times 40, in thousandths.
uint32_t robot_speed(bool is_turn, uint8_t power) {
  const Pace::Line& line = port_tuning().pace.lines[is_turn];
  if (line.at80 <= line.at40) return board_speed(is_turn) * power;  // not measured, or not sound
  const uint16_t rise = static_cast<uint16_t>(line.at80 - line.at40);
  const uint16_t quarters = static_cast<uint16_t>(25 * power);
  const int32_t found =
      (int32_t{line.at40} - rise) * 1000 + static_cast<int32_t>(uint32_t{rise} * quarters);
  return found < 0 ? 0 : static_cast<uint32_t>(found);
}

}  // namespace tiniscript
