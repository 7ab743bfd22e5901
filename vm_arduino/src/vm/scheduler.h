// The turns of tasks: who goes on, and when.
//
// `task_steps.cpp` has what is the same on every chip, `turns.cpp` the rest, which is in
// `tasks_avr.S` for an Uno. Without tasks, none of these functions is called. Has the names of
// `TaskMachine` in `tasks.py`; `tests/project/test_twins.py` lists what has another.

#pragma once

#include <stdint.h>

#include "drive.h"

namespace tiniscript {

class Scheduler : public Drive {
 protected:
  // Makes a record for each task.
  void find_tasks();

  // Goes on with a turn, or begins the next one of the round; `is_over`: ends the turn before. False:
  // the round is over.
  bool finds_turn(bool is_over);

  // Whether the first turn, of the main task before all others, is over.
  bool has_had_turn() const { return (task_.other_tasks & kHasHadTurn) != 0; }

  // When the next task is due: it may be at once, or was.
  uint32_t wake_ms() const;

  // The effects of instructions in a task. Each returns whether the next one may run now.
  bool go_back();
  bool look(bool holds);
  bool look_again();
  bool sends() tini_called_by_assembly;

  // Ends this task. Returns whether it was the last one.
  bool end_task();

 private:
  bool waits_for_clock(const TaskRecord* task) const;
  bool is_due(const TaskRecord* task) const;
  bool begin_turn(TaskRecord* task);
  void end_turn();
  void begin_others();
  void end_round();
  void pass_on();
};

}  // namespace tiniscript
