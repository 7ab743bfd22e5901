// Waits and moves of the task whose turn it is, and who has the motors.
//
// One of three files implements it, as `build.h` says: `drive.cpp` where a higher task may take the
// motors, `tasks_avr.S` for an Uno, `drive_alone.cpp` where there are no tasks. Has the names of
// `TaskMachine` in `tasks.py` and, where there are no tasks, of `Drive` in `state.py`;
// `tests/project/test_twins.py` lists what has another.

#pragma once

#include <stdint.h>

#include "small.h"
#include "state.h"

namespace tiniscript {

class Drive : public Execution {
 protected:
  // Each returns whether the next instruction may run now.
  bool wait(uint32_t duration_ms);
  bool drive(uint32_t move_ms);
  bool watch(uint32_t move_ms);  // begins to watch a move or a wait
  bool until(bool stop) tini_called_by_assembly;  // continues or ends it
  bool go_on();
  bool comes_to_end();

  void motors(Powers powers);
  void stop_motors();
  void set_motors(Powers powers) tini_called_by_assembly;

  // Waits for the motors where its move needs them and a higher task has them.
  bool blocks();

  // A new program has no way that the robot measures.
  static void forget_way();

  // How far the clock of a task lags now; `execute_control_avr.S` is the same for the AVR.
  uint32_t late_ms(const TaskRecord* task) const;

  // Sets a task's clock to now.
  void set_clock(TaskRecord* task) const { task->clock_ms = now_ms_; }

  // Sets the clock to the begin of the next wait or move, or to now if that is too long ago.
  void begin(TaskRecord* task) const {
    if (late_ms(task) > kLateMs) set_clock(task);
  }

  // The time between its clock, at the last check, and the next check of its UNTIL.
  uint32_t next_check_ms(const TaskRecord* task) const {
    const uint32_t lag_ms = late_ms(task);
    uint32_t next_ms = kCheckMs;
    while (next_ms <= lag_ms) next_ms += kCheckMs;  // rarely even once
    return next_ms;
  }

 private:
  void keep_move(uint32_t move_ms);
  void go_way();
  bool continues_way();
  void end_move();
  void leave_move(TaskRecord* task);
  void stand_still(TaskRecord* task);
  bool is_below() const;
  void take_motors();
  void set_motors_of_move();
};

// The powers of a move. The last two bits of its code are the direction: F, B, L, R.
inline Powers powers_of_move(const TaskRecord* task) {
  int8_t left = task->power < 0 ? 0 : task->power;
  if ((task->code & 1) != 0) left = static_cast<int8_t>(-left);
  const int8_t right = left;
  if ((task->code & 2) != 0) left = static_cast<int8_t>(-left);
  return powers_of(left, right);
}

}  // namespace tiniscript
