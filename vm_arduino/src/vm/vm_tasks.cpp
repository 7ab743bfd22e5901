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

#ifdef __AVR__
// Whether an instruction that has used up a budget is a call, and not a jump back.
bool is_call(uint8_t code) {
  return static_cast<uint8_t>(code - static_cast<uint8_t>(Op::kCall)) < 2;
}
#else
constexpr int32_t kNeverMs = 0x7fffffff;  // from now: nothing happens by itself
#endif

// Moves the first `count` of `all` frames behind the others.
void to_the_end(Frame* frames, uint8_t count, uint8_t all) {
  for (; count != 0; count--) {
    Frame* at = frames;
    const Frame first = *at;
    for (uint8_t left = all; left > 1; left--, at++) *at = at[1];
    *at = first;
  }
}

}  // namespace

// Makes a record for each task in the order of rank, the main task behind them; all of it is 0.
void Machine::find_tasks() {
  TaskRecord* me = task_.next = task_.records;
  Role kind = Role::kWhen;
  for (;;) {
    for (uint16_t at = 0; at < length_;) {
      const Shape shape = shape_of(code_[at]);
      at = static_cast<uint16_t>(at + shape.size());
      if (shape.role() != kind || me == task_.records + kTasks) continue;
      me->pc = at;
      if (kind == Role::kWhen) me->start = at;
      me++;
      task_.others = static_cast<uint8_t>((task_.others + 1) | kHasOthers);
    }
    if (kind == Role::kTask) break;
    kind = Role::kTask;
  }
  task_.me = me;
  task_.end = task_.holder = me + 1;
}

// Goes on to where the next instruction begins. False: none may run now.
bool Machine::arrive(uint32_t now_ms) {
  if (status_ >= Status::kDone) return false;
  return fault_ != Fault::kNone || (may_go_on(now_ms) && finds_turn(false)) ||
         fault_ != Fault::kNone;
}

// Runs turns until the round is over or the budget is used up.
tini_noinline void Machine::run_round() {
#ifdef __AVR__
  // The inner loop leaves at each jump back, where a loop may wait.
  uint8_t left = left_;
  bool is_over = false;
  while (finds_turn(is_over) && left != 0) {
    execute(1);
    if (fault_ != Fault::kNone || status_ == Status::kDone) break;
    is_over = true;
    if (left_ == 0) {
      left--;
      is_over = !is_call(code_[at_]) && !goes_back();
      if (!is_over && Flag<Bit::kAttention>()) break;
    } else if (task_.turns == 0 && status_ == Status::kRunning) {
      break;
    }
  }
  left_ = left;
#else
  for (bool is_over = false; finds_turn(is_over) && left_ != 0; is_over = true) {
    if (execute(left_) || fault_ != Fault::kNone || status_ == Status::kDone) return;
    // before all others the main task waits for a reading, too
    if (task_.turns == 0 && status_ == Status::kRunning) return;
  }
#endif
}

// Goes on with a turn, or begins the next one of the round; `is_over`: ends the turn before. False:
// the round is over.
tini_noclone bool Machine::finds_turn(bool is_over) {
  for (;;) {
    if (is_over) end_turn();
    if (!task_.is_between_turns) return true;
    if (kHasDiscs && fault_ != Fault::kNone) return false;
    TaskRecord* const task = task_.next;
    if (task == task_.end) {
      task_.next = task_.records;
      task_.turns = 2;
      pause();
      end_round();
      return false;
    }
    // The frames of the next one come to the end of those that all tasks share.
    to_the_end(task_.frames, task->framed, task_.framed);
    task_.next = task + 1;
    is_over = waits_for_clock(task) && static_cast<int32_t>(late_ms(task)) >= 0 &&
              !begin_turn(task);
  }
}

// Whether it waits for its clock, and not for the motors or for nothing any more.
tini_noclone bool Machine::waits_for_clock(const TaskRecord* task) const {
  return !task->is(kIsBlocked) || task_.holder == task;
}

// A round is over.
tini_noclone inline void Machine::end_round() {
#ifdef __AVR__
  task_.round_ms = static_cast<uint8_t>(now_ms_ - task_.had_turn);
  task_.had_turn = false;
#else
  int32_t more_ms = kNeverMs;
  for (const TaskRecord* task = task_.records; task != task_.end; task++) {
    const int32_t its_ms = static_cast<int32_t>(task->clock_ms - now_ms_);
    if (its_ms < more_ms && waits_for_clock(task)) more_ms = its_ms;
  }
  task_.wake_ms = now_ms_ + static_cast<uint32_t>(more_ms);
#endif
}

// Returns whether it goes on.
tini_noclone bool Machine::begin_turn(TaskRecord* me) {
  task_.me = me;
  task_.is_between_turns = false;
  me->framed = static_cast<uint8_t>(me->framed - task_.framed);  // `end_turn` adds what it is then
  task_.pc = me->pc;
  if ((me->more & kUnsent) != 0 && !sends()) return false;
  if (me->is(kIsBlocked)) {
    me->state &= static_cast<uint8_t>(~kIsBlocked);
    set_clock(me);
    return me->check != me->after || go_on(false);
  }
  return !me->is(kToItsEnd) || comes_to_end();
}

tini_noclone void Machine::end_turn() {
  TaskRecord* const me = task_.me;
  me->pc = task_.pc;
  me->framed = static_cast<uint8_t>(me->framed + task_.framed);
  task_.is_between_turns = true;
#ifdef __AVR__
  task_.had_turn = true;
#endif
  status_ = Status::kRunning;
  if (task_.turns == 0) {
    task_.turns = 1;
    for (TaskRecord* task = task_.records; task != me; task++) set_clock(task);
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
tini_noclone bool Machine::goes_back() {
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
  me->state &= static_cast<uint8_t>(~(kKeeps | kHasSet));
  return look_again();
}

bool Machine::look_again() {
  task_.pc = task_.me->start;
  return wait(kCheckMs);
}

// Ends this task. Returns whether it was the last one.
bool Machine::ends_program() {
  task_.me->state = kHasEnded;
  return task_.others-- == kHasOthers || pause();
}

}  // namespace tiniscript

#endif
