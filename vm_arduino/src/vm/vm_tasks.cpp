// The turns of tasks.
//
// Matches `tasks.py` method by method. What an instruction does is where it is for all programs.

#include "../robot.h"
#include "bytecode.h"

#ifdef tiniscript_has_tasks

#include "flags.h"
#include "shape.h"
#include "small.h"
#include "vm.h"

namespace tiniscript {

namespace {

constexpr int32_t kNeverMs = 0x7fffffff;  // from now: nothing happens by itself

// Moves the first `count` of `all` values behind the others.
template <class Value>
tini_noinline void to_the_end(Value* values, uint8_t count, uint8_t all) {
  if (count == all) return;
  for (; count != 0; count--) {
    const Value first = values[0];
    for (uint8_t k = 1; k < all; k++) values[k - 1] = values[k];
    values[all - 1] = first;
  }
}

}  // namespace

// Makes a record for each task in the order of rank, the main task behind them.
void Machine::find_tasks() {
  __builtin_memset(task_.records, 0, sizeof task_.records);
  task_.me = task_.next = task_.records;
  Role kind = Role::kWhen;
  for (;;) {
    for (uint16_t at = 0; at < length_;) {
      const Shape shape = shape_of(code_[at]);
      at = static_cast<uint16_t>(at + shape.size());
      if (shape.role() != kind || task_.me == task_.records + kTasks) continue;
      task_.me->pc = at;
      if (kind == Role::kWhen) task_.me->start = at;
      task_.me++;
    }
    if (kind == Role::kTask) break;
    kind = Role::kTask;
  }
  task_.end = task_.holder = task_.me + 1;
  task_.is_in_turn = task_.is_first = task_.is_first_round = true;
}

// Goes on to where the next instruction begins. False: none may run now.
bool Machine::arrive(uint32_t now_ms) {
  return status_ < Status::kDone && may_go_on(now_ms) && finds_turn();
}

// Runs turns until the round is over or the budget is used up.
void Machine::run_round() {
  while (left_ != 0 && fault_ == Fault::kNone && finds_turn()) {
    if (run_turn() || fault_ != Fault::kNone || status_ == Status::kDone) return;
    // before all others the main task waits for a reading, too
    if (task_.is_first && !task_.has_paused) return;
    end_turn();
  }
}

// Returns whether the budget ends it, and not the turn.
bool Machine::run_turn() {
#ifdef __AVR__
  // The inner loop leaves at each jump back, where a loop may wait.
  uint8_t left = left_;
  bool goes_on;
  do {
    execute(1);
    goes_on = left_ == 0 && fault_ == Fault::kNone;
    if (!goes_on) break;
    left--;
    goes_on = shape_of(code_[at_]).role() == Role::kCall || goes_back();
  } while (goes_on && left != 0 && !Flag<Bit::kAttention>());
  left_ = left;
  return goes_on;
#else
  return execute(left_);
#endif
}

// Goes on with a turn, or begins the next one of the round. False: the round is over.
bool Machine::finds_turn() {
  while (!task_.is_in_turn) {
    TaskRecord* const task = task_.next;
    if (task == task_.end) {
      task_.next = task_.records;
      task_.is_first_round = false;
      task_.clock_ms = next_wake_ms();
      task_.has_paused = true;
      status_ =
          static_cast<int32_t>(now_ms_ - task_.clock_ms) >= 0 ? Status::kRunning : Status::kWaiting;
      return false;
    }
    // The counters and calls of the next one come to the end of those that all tasks share.
    to_the_end(task_.counters, task->looped, task_.looped);
    to_the_end(task_.calls, task->called, task_.called);
    task_.next = task + 1;
    if (waits_for_clock(task) && static_cast<int32_t>(now_ms_ - task->clock_ms) >= 0) {
      begin_turn(task);
    }
  }
  return true;
}

bool Machine::waits_for_clock(const TaskRecord* task) const {
  return task->is(kIsBlocked) ? task_.holder == task : (task->more & kHasEnded) == 0;
}

uint32_t Machine::next_wake_ms() const {
  int32_t more_ms = kNeverMs;
  for (const TaskRecord* task = task_.records; task != task_.end; task++) {
    const int32_t its_ms = static_cast<int32_t>(task->clock_ms - now_ms_);
    if (its_ms < more_ms && waits_for_clock(task)) more_ms = its_ms;
  }
  return now_ms_ + static_cast<uint32_t>(more_ms);
}

void Machine::begin_turn(TaskRecord* me) {
  task_.me = me;
  task_.is_in_turn = true;
  task_.looped_below = static_cast<uint8_t>(task_.looped - me->looped);
  task_.called_below = static_cast<uint8_t>(task_.called - me->called);
  task_.pc = me->pc;
  task_.clock_ms = me->clock_ms;
  bool goes_on = (me->more & kUnsent) == 0 || sends();
  if (!goes_on) {
  } else if (me->is(kIsBlocked)) {
    me->state &= static_cast<uint8_t>(~kIsBlocked);
    task_.clock_ms = now_ms_;
    goes_on = me->check != me->after || go_on(false);
  } else if (me->is(kToItsEnd)) {
    end_move();
  }
  if (!goes_on) end_turn();
}

void Machine::end_turn() {
  TaskRecord* const me = task_.me;
  me->pc = task_.pc;
  me->clock_ms = task_.clock_ms;
  if (task_.looped < task_.looped_below || task_.called < task_.called_below) fail();
  me->looped = static_cast<uint8_t>(task_.looped - task_.looped_below);
  me->called = static_cast<uint8_t>(task_.called - task_.called_below);
  task_.is_in_turn = task_.has_paused = false;
  status_ = Status::kRunning;
  if (task_.is_first) {
    task_.is_first = false;
    for (TaskRecord* task = task_.records; task != me; task++) task->clock_ms = now_ms_;
  }
  pass_on();
}

// Sends the value that a SHOW has kept. Returns whether there was room.
bool Machine::sends() {
  TaskRecord* const me = task_.me;
  if (!robot_show(static_cast<int32_t>(me->rest_ms), (me->more & kYesNo) != 0)) return false;
  me->more = 0;
  return true;
}

// Goes back to the start of a loop, where a task that has not waited since it last did so waits.
bool Machine::goes_back() {
  TaskRecord* const me = task_.me;
  const bool has_waited = me->is(kHasWaited);
  if (!has_waited) wait(1);
  me->state &= static_cast<uint8_t>(~kHasWaited);
  return has_waited;
}

// Goes on in a WHEN, or looks once more.
bool Machine::look(bool holds) {
  if (holds) return true;
  TaskRecord* const me = task_.me;
  me->set = 0;
  me->state &= static_cast<uint8_t>(~(kKeeps | kHasSet));
  return look_again();
}

bool Machine::look_again() {
  task_.pc = task_.me->start;
  return wait(kCheckMs);
}

// Ends this task. Returns whether it was the last one.
bool Machine::ends_program() {
  task_.me->more = kHasEnded;
  task_.me->set = 0;
  task_.me->state &= static_cast<uint8_t>(~kHasSet);
  stay();  // behind the last END lies nothing
  for (const TaskRecord* task = task_.records; task != task_.end; task++) {
    if ((task->more & kHasEnded) == 0) return pause();
  }
  return true;
}

}  // namespace tiniscript

#endif
