// The turns of tasks, and their round. `tasks_avr.S` is the same for an Uno without discs.

#include "build.h"

#ifdef tiniscript_drives_in_turns

#include "machine.h"

namespace tiniscript {

namespace {

// Moves the first `count` of `total` frames after the others.
void rotate_frames(Frame* frames, uint8_t count, uint8_t total) {
  for (; count != 0; count--) {
    Frame* frame = frames;
    const Frame first = *frame;
    for (uint8_t remaining = total; remaining > 1; remaining--, frame++) *frame = frame[1];
    *frame = first;
  }
}

}  // namespace

void Machine::run_round() {
  for (bool is_over = false; finds_turn(is_over) && budget_left_ != 0; is_over = true) {
    if (run_turn() || fault_ != Fault::kNone || status_ == Status::kDone) return;
    // before all others the main task waits for a reading, too
    if (!has_had_turn() && status_ == Status::kRunning) return;
  }
}

bool Scheduler::finds_turn(bool is_over) {
  if (!is_over && task_.current != nullptr) return true;
  for (;;) {
    if (is_over) end_turn();
    if (kHasDiscs && fault_ != Fault::kNone) return false;
    TaskRecord* task = task_.current;
    if (task == task_.main_task()) {
      if (has_had_turn()) {
        end_round();
        return pause();
      }
      begin_others();
      task = nullptr;
    }
    if (task == nullptr) {
      task_.is_quiet = true;
      task = task_.records;
    } else {
      task++;
    }
    task_.current = task;
    // The frames of the next one come to the end of those that all tasks share.
    rotate_frames(task_.frames, task->frame_count, task_.frame_count);
    is_over = is_due(task);
    if (is_over && begin_turn(task)) return true;
  }
}

// The first turn is over.
void Scheduler::begin_others() {
  task_.other_tasks |= kHasHadTurn | kIsFirstRound;
  for (TaskRecord* task = task_.records; task != task_.main_task(); task++) set_clock(task);
}

// A round is over.
void Scheduler::end_round() {
  task_.current = nullptr;
  task_.other_tasks &= static_cast<uint8_t>(~kIsFirstRound);
}

bool Scheduler::is_due(const TaskRecord* task) const {
  return waits_for_clock(task) && static_cast<int32_t>(late_ms(task)) >= 0;
}

// Returns whether it goes on.
bool Scheduler::begin_turn(TaskRecord* task) {
  task->frame_count = static_cast<uint8_t>(task->frame_count -
                                           task_.frame_count);  // `end_turn` adds what it is then
  task_.pc = task->pc;
  if (task->has_unsent() && !sends()) return false;
  // the motors may have been taken since its check began
  if (!task->is(kHasBegun) && blocks()) return false;
  if (!task->is(kHasTime)) {
    task->state |= kHasTime;
    set_clock(task);
    return task->is_watched() || go_on();
  }
  return !task->is(kToItsEnd) || comes_to_end();
}

void Scheduler::end_turn() {
  TaskRecord* const task = task_.current;
  task->pc = task_.pc;
  task->frame_count = static_cast<uint8_t>(task->frame_count + task_.frame_count);
  status_ = Status::kRunning;
  task_.is_quiet = false;
  pass_on();
}

// Goes back to the start of a loop, where a task that has not waited since it last did so waits.
bool Scheduler::go_back() {
  TaskRecord* const task = task_.current;
  const bool has_waited = task->is(kHasWaited);
  if (!has_waited) wait(1);
  task->state &= static_cast<uint8_t>(~kHasWaited);
  return has_waited;
}

// After a turn: gives the motors to the highest task that wants them, if it is another.
void Scheduler::pass_on() {
  TaskRecord* highest = task_.records;
  while (highest != task_.main_task() && !highest->is(kWantsMotors)) highest++;
  if (highest->is(kDrives)) return;
  if (highest != task_.holder && !highest->is(kHasTime)) {
    highest->clock_ms = now_ms_ + (task_.other_tasks & kIsFirstRound);
  }
  const Powers previous_powers = task_.holder->own_powers;
  task_.holder = highest;
  if (!highest->is(kHoldsPowers)) highest->own_powers = kMotorsOff;
  if (highest->own_powers != previous_powers) set_motors(highest->own_powers);
}

}  // namespace tiniscript

#endif
