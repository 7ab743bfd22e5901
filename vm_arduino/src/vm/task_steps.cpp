// The turn of a task apart from moving, and the time of its next turn: on every chip.

#include "build.h"

#ifdef tiniscript_has_tasks

#include "../robot.h"
#include "decode_form.h"
#include "scheduler.h"

namespace tiniscript {

// Makes a record for each task in the order of rank; between them and the main task are those of
// none. All of it is 0.
void Scheduler::find_tasks() {
  TaskRecord* task = task_.records;
  ControlRole kind = ControlRole::kWhen;
  for (;;) {
    for (uint16_t offset = 0; offset < length_;) {
      const DecodeForm form = decode_form_of(code_[offset]);
      offset = static_cast<uint16_t>(offset + form.size());
      if (form.role() != kind || task == task_.main_task()) continue;
      task->state = kAtFirst;
      task->pc = offset;
      if (kind == ControlRole::kWhen) task->start = offset;
      task++;
      task_.other_tasks = static_cast<uint8_t>((task_.other_tasks + kOneOther) | kHasOthers);
    }
    if (kind == ControlRole::kTask) break;
    kind = ControlRole::kTask;
  }
  task_.current = task_.holder = task_.main_task();
  task_.current->state = kAtFirst;
}

// Sends the value that a SHOW has kept. Returns whether there was room.
bool Scheduler::sends() {
  TaskRecord* const task = task_.current;
  if (!robot_show(static_cast<int32_t>(task->rest_ms), task->shows_yes_no())) return false;
  task->code = static_cast<uint8_t>(Op::kWait);
  return true;
}

// Goes on in a WHEN, or looks once more.
bool Scheduler::look(bool holds) {
  if (holds) return true;
  TaskRecord* const task = task_.current;
  task->state &= static_cast<uint8_t>(~(kKeeps | kHoldsPowers));
  return look_again();
}

bool Scheduler::look_again() {
  task_.pc = task_.current->start;
  return wait(kCheckMs);
}

// Ends this task. Returns whether it was the last one.
bool Scheduler::end_task() {
  task_.current->state = 0;
  if ((task_.other_tasks & kAllOthers) == 0) return true;
  task_.other_tasks = static_cast<uint8_t>(task_.other_tasks - kOneOther);
  return pause();
}

// Whether it waits only for its clock, and not for the motors.
bool Scheduler::waits_for_clock(const TaskRecord* task) const {
  return task->is(kHasTime) || (task_.holder == task && task->is(kIsMoving));
}

// When the next task is due.
uint32_t Scheduler::wake_ms() const {
  int32_t next_ms = 0x7fffffff;  // nothing happens by itself
  for (const TaskRecord* task = task_.records; task <= task_.records + kTasks; task++) {
    const int32_t left_ms = static_cast<int32_t>(task->clock_ms - now_ms_);
    if (left_ms < next_ms && waits_for_clock(task)) next_ms = left_ms;
  }
  return now_ms_ + static_cast<uint32_t>(next_ms);
}

}  // namespace tiniscript

#endif
