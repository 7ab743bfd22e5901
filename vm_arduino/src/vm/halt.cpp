#include "../robot.h"
#include "machine.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

void Machine::resume() {
  if (status_ != Status::kHalted) return;
  fault_ = Fault::kNone;
  status_ = Status::kRunning;
  task_.pc = offset_;
  task_.depth = 0;
}

uint8_t Machine::turn() const { return static_cast<uint8_t>(task_.current - task_.records); }

uint16_t Machine::place_of(uint8_t task) const {
  const TaskRecord* const record = task_.records + task;
  return record == task_.current ? task_.pc : record->pc;
}

uint16_t Machine::return_place() const {
  if (task_.frame_count == 0) return length_;
  const Frame& frame = task_.frames[task_.frame_count - 1];
  uint16_t place;
  __builtin_memcpy(&place, &frame, sizeof place);  // little-endian; an AVR keeps an address
  if (kInAssembly) place = static_cast<uint16_t>(place - reinterpret_cast<uintptr_t>(code_));
  return place;
}

void Machine::set_motors_again() {
  const TaskRecord* const holder = task_.holder;
  const int8_t left = static_cast<int8_t>(holder->own_powers);
  const int8_t right = static_cast<int8_t>(holder->own_powers >> 8);
  if (holder->is(kDrives) && holder->measures()) return robot_go_on(left, right);
  robot_motors(left, right);
}

}  // namespace tiniscript

#endif
