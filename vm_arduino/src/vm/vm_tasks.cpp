// The turns of tasks.
//
// Matches `tasks.py` method by method. What an instruction does is where it is for all programs.
// `tasks_avr.S` is the second half of this for the AVR.

#include "../robot.h"
#include "bytecode.h"

#ifdef tiniscript_has_tasks

#include "decode_form.h"
#include "small.h"
#include "vm.h"

namespace tiniscript {

// Makes a record for each task in the order of rank; between them and the main task are those of
// none. All of it is 0.
void Machine::find_tasks() {
  TaskRecord* me = task_.records;
  ControlRole kind = ControlRole::kWhen;
  for (;;) {
    for (uint16_t at = 0; at < length_;) {
      const DecodeForm form = decode_form_of(code_[at]);
      at = static_cast<uint16_t>(at + form.size());
      if (form.role() != kind || me == main_task()) continue;
      me->state = kAtFirst;
      me->pc = at;
      if (kind == ControlRole::kWhen) me->start = at;
      me++;
      task_.others = static_cast<uint8_t>((task_.others + kOneOther) | kHasOthers);
    }
    if (kind == ControlRole::kTask) break;
    kind = ControlRole::kTask;
  }
  task_.me = task_.holder = main_task();
  task_.me->state = kAtFirst;
}

// Sends the value that a SHOW has kept. Returns whether there was room.
bool Machine::sends() {
  TaskRecord* const me = task_.me;
  if (!robot_show(static_cast<int32_t>(me->rest_ms), me->shows_yes_no())) return false;
  me->code = static_cast<uint8_t>(Op::kWait);
  return true;
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
  task_.me->state = 0;
  if ((task_.others & kAllOthers) == 0) return true;
  task_.others = static_cast<uint8_t>(task_.others - kOneOther);
  return pause();
}

// Whether it waits for its clock, and not for the motors or for nothing any more.
bool Machine::waits_for_clock(const TaskRecord* task) const {
  return task->is(kHasTime) || (task_.holder == task && task->is(kIsMoving));
}

// When the next task is due.
uint32_t Machine::next_turn_ms() const {
  int32_t more_ms = 0x7fffffff;  // nothing happens by itself
  for (const TaskRecord* task = task_.records; task <= task_.records + kTasks; task++) {
    const int32_t its_ms = static_cast<int32_t>(task->clock_ms - now_ms_);
    if (its_ms < more_ms && waits_for_clock(task)) more_ms = its_ms;
  }
  return now_ms_ + static_cast<uint32_t>(more_ms);
}

#ifndef tiniscript_in_assembly

namespace {

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

// Goes on to where the next instruction begins. False: none may run now.
bool Machine::arrive(uint32_t now_ms) {
  if (status_ >= Status::kDone) return false;
  return fault_ != Fault::kNone || (may_go_on(now_ms) && finds_turn(false)) ||
         fault_ != Fault::kNone;
}

// Runs turns until the round is over or the budget is used up.
void Machine::run_round() {
  for (bool is_over = false; finds_turn(is_over) && left_ != 0; is_over = true) {
    if (execute(left_) || fault_ != Fault::kNone || status_ == Status::kDone) return;
    // before all others the main task waits for a reading, too
    if (!has_had_turn() && status_ == Status::kRunning) return;
  }
}

// Goes on with a turn, or begins the next one of the round; `is_over`: ends the turn before. False:
// the round is over.
bool Machine::finds_turn(bool is_over) {
  if (!is_over && task_.me != nullptr) return true;
  for (;;) {
    if (is_over) end_turn();
    if (kHasDiscs && fault_ != Fault::kNone) return false;
    TaskRecord* task = task_.me;
    if (task == main_task()) {
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
    task_.me = task;
    // The frames of the next one come to the end of those that all tasks share.
    to_the_end(task_.frames, task->framed, task_.framed);
    is_over = waits_for_clock(task) && static_cast<int32_t>(late_ms(task)) >= 0;
    if (is_over && begin_turn(task)) return true;
  }
}

// The first turn is over.
void Machine::begin_others() {
  task_.others |= kHasHadTurn | kIsFirstRound;
  for (TaskRecord* task = task_.records; task != main_task(); task++) set_clock(task);
}

// A round is over.
void Machine::end_round() {
  task_.me = nullptr;
  task_.others &= static_cast<uint8_t>(~kIsFirstRound);
}

// Returns whether it goes on.
bool Machine::begin_turn(TaskRecord* me) {
  me->framed = static_cast<uint8_t>(me->framed - task_.framed);  // `end_turn` adds what it is then
  task_.pc = me->pc;
  if (me->has_unsent() && !sends()) return false;
  // the motors may have been taken since its check began
  if (!me->is(kHasBegun) && blocks()) return false;
  if (!me->is(kHasTime)) {
    me->state |= kHasTime;
    set_clock(me);
    return me->is_watched() || go_on();
  }
  return !me->is(kToItsEnd) || comes_to_end();
}

void Machine::end_turn() {
  TaskRecord* const me = task_.me;
  me->pc = task_.pc;
  me->framed = static_cast<uint8_t>(me->framed + task_.framed);
  status_ = Status::kRunning;
  task_.is_quiet = false;
  pass_on();
}

// Goes back to the start of a loop, where a task that has not waited since it last did so waits.
bool Machine::goes_back() {
  TaskRecord* const me = task_.me;
  const bool has_waited = me->is(kHasWaited);
  if (!has_waited) wait(1);
  me->state &= static_cast<uint8_t>(~kHasWaited);
  return has_waited;
}

// Behind a turn: gives the motors to the highest task that wants them, if it is another.
void Machine::pass_on() {
  TaskRecord* highest = task_.records;
  while (highest != main_task() && !highest->is(kWantsMotors)) highest++;
  if (highest->is(kDrives)) return;
  if (highest != task_.holder && !highest->is(kHasTime)) {
    highest->clock_ms = now_ms_ + (task_.others & kIsFirstRound);
  }
  const Powers before = task_.holder->set;
  task_.holder = highest;
  if (!highest->is(kHasSet)) highest->set = kMotorsOff;
  if (highest->set != before) set_motors(highest->set);
}

#endif

}  // namespace tiniscript

#endif
