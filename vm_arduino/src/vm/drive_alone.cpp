// Waits and moves of a machine without tasks: nobody takes the motors away.

#include "build.h"

#ifdef tiniscript_drives_alone

#include "drive.h"

namespace tiniscript {

bool Drive::drive(uint32_t move_ms) {
  TaskRecord* const task = task_.current;
  if (task->is_move()) {
    set_motors_of_move();
    task->state = kToItsEnd;
  }
  begin(task);
  task->clock_ms += move_ms;
  return pause();
}

bool Drive::watch(uint32_t move_ms) {
  keep_move(move_ms);
  return true;
}

// Keeps the move or wait that an UNTIL watches; its check begins after this instruction.
void Drive::keep_move(uint32_t move_ms) {
  TaskRecord* const task = task_.current;
  task->rest_ms = move_ms;
  task->check = task_.pc;
  task->state &= static_cast<uint8_t>(~kHasBegun);
}

bool Drive::until(bool stop) {
  TaskRecord* const task = task_.current;
  const bool drives = task->is_move();
  if (stop) {
    if (!task->is(kHasBegun)) return true;
    task->clock_ms = now_ms_;
    if (drives) set_motors(kMotorsOff);
    return true;
  }
  if (!task->is(kHasBegun)) {
    task->state = kHasBegun;
    begin(task);
    if (drives) set_motors_of_move();
  }
  uint32_t next_ms = next_check_ms(task);
  if (next_ms < task->rest_ms) {
    task_.pc = task->check;
    if (!task->is_forever()) task->rest_ms -= next_ms;
  } else {
    next_ms = task->rest_ms;
    if (drives) task->state = kToItsEnd;
  }
  task->clock_ms += next_ms;
  return pause();
}

void Drive::end_move() {
  task_.current->state = 0;
  set_motors(kMotorsOff);
}

bool Drive::comes_to_end() {
  end_move();
  return true;
}

tini_noinline void Drive::set_motors_of_move() { set_motors(powers_of_move(task_.current)); }
void Drive::motors(Powers powers) { set_motors(powers); }
void Drive::stop_motors() { set_motors(kMotorsOff); }

}  // namespace tiniscript

#endif
