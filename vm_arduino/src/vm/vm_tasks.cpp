// The turns of tasks, and who has the motors: for programs with TASK and WHEN.
//
// Matches `tasks.py` method by method. What an instruction does is where it is for all programs.

#include "../robot.h"
#include "bytecode.h"

#ifdef tiniscript_has_tasks

#include "flags.h"
#include "shape.h"
#include "vm.h"

namespace tiniscript {

namespace {

constexpr int32_t kNeverMs = 0x7fffffff;  // from now: nothing happens by itself

void forget_set(TaskRecord* task) {
  task->set_left = task->set_right = 0;
  task->has_set = false;
}

// Its move is over, and so is its M. It goes on behind the move.
void end_move_of(TaskRecord* task) {
  task->is_moving = task->is_blocked = task->drives = task->to_its_end = false;
  forget_set(task);
  task->pc = task->after;
}

// Its move that drives loses the motors.
void stand_still(TaskRecord* task, uint32_t now_ms) {
  if (task->rest_ms != kForever) {
    const uint32_t left_ms = task->clock_ms + task->rest_ms - now_ms;
    if (static_cast<int32_t>(left_ms) <= 0) {
      end_move_of(task);
      return;
    }
    task->rest_ms = left_ms;
  }
  task->is_blocked = true;
  task->drives = task->has_begun = task->to_its_end = false;
  task->pc = task->check;
}

// Moves `count` of `all` values, which begin `at`, behind the others.
template <class Value>
void to_the_end(Value* values, uint8_t at, uint8_t count, uint8_t all) {
  for (; count != 0; count--) {
    const Value first = values[at];
    for (uint8_t k = at; k + 1 < all; k++) values[k] = values[k + 1];
    values[all - 1] = first;
  }
}

void move_down(uint8_t* place, uint8_t behind, uint8_t by) {
  if (*place > behind) *place = static_cast<uint8_t>(*place - by);
}

}  // namespace

// -- turns ----------------------------------------------------------------------------------------

// Makes a record for each task in the order of rank, if there is one beside the main task.
void Machine::find_tasks() {
  tasks_.count = tasks_.me = 0;
  if (!has_task(code_, length_)) return;
  tasks_ = Tasks();
  const Role kinds[] = {Role::kWhen, Role::kTask};
  for (const Role kind : kinds) {
    for (uint32_t at = 0; at < length_ && tasks_.count < kTasks;) {
      const Shape shape = shape_of(code_[at]);
      at += shape.size();
      if (shape.role() != kind) continue;
      TaskRecord* const task = tasks_.records + tasks_.count++;
      task->pc = task->start = static_cast<uint16_t>(at);
      task->is_when = kind == Role::kWhen;
    }
  }
  tasks_.me = tasks_.count++;
  tasks_.holder = kNobody;
  tasks_.is_in_turn = tasks_.is_first = tasks_.is_first_round = true;
}

// Goes on to where the next instruction begins. False: none may run now.
bool Machine::arrive(uint32_t now_ms) {
  if (status_ >= Status::kDone || !may_go_on(now_ms)) return false;
  return finds_turn();
}

// Runs turns until the round is over or the budget is used up.
void Machine::run_round() {
  while (left_ != 0 && fault_ == Fault::kNone && finds_turn()) {
    if (run_turn() || fault_ != Fault::kNone || status_ == Status::kDone) return;
    // before all others the main task waits for a reading, too
    if (tasks_.is_first && task_.wait == Wait::kNothing) return;
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
  while (!tasks_.is_in_turn) {
    if (tasks_.next == tasks_.count) {
      tasks_.next = 0;
      tasks_.is_first_round = false;
      task_.clock_ms = next_wake_ms();
      task_.wait = Wait::kPause;
      const bool is_due = static_cast<int32_t>(now_ms_ - task_.clock_ms) >= 0;
      status_ = is_due ? Status::kRunning : Status::kWaiting;
      return false;
    }
    const uint8_t rank = tasks_.next++;
    const bool is_reached = static_cast<int32_t>(now_ms_ - tasks_.records[rank].clock_ms) >= 0;
    if (is_reached && waits_for_clock(rank)) begin_turn(rank);
  }
  return true;
}

bool Machine::waits_for_clock(uint8_t rank) const {
  const TaskRecord& task = tasks_.records[rank];
  return task.is_blocked ? tasks_.holder == rank : !task.has_ended;
}

uint32_t Machine::next_wake_ms() const {
  int32_t more_ms = kNeverMs;
  for (uint8_t rank = 0; rank < tasks_.count; rank++) {
    const int32_t its_ms = static_cast<int32_t>(tasks_.records[rank].clock_ms - now_ms_);
    if (waits_for_clock(rank) && its_ms < more_ms) more_ms = its_ms;
  }
  return now_ms_ + static_cast<uint32_t>(more_ms);
}

// Its counters and its calls come to the end of those that all tasks share.
void Machine::begin_turn(uint8_t rank) {
  tasks_.me = rank;
  tasks_.is_in_turn = true;
  TaskRecord* const me = tasks_.records + rank;
  to_the_end(task_.counters, me->looped_at, me->looped, task_.looped);
  to_the_end(task_.calls, me->called_at, me->called, task_.called);
  for (uint8_t k = 0; k < tasks_.count; k++) {
    TaskRecord* const other = tasks_.records + k;
    move_down(&other->looped_at, me->looped_at, me->looped);
    move_down(&other->called_at, me->called_at, me->called);
  }
  me->looped_at = static_cast<uint8_t>(task_.looped - me->looped);
  me->called_at = static_cast<uint8_t>(task_.called - me->called);
  task_.pc = me->pc;
  task_.clock_ms = me->clock_ms;
  if (me->has_unsent && !sends()) {
    end_turn();
    return;
  }
  if (me->is_blocked) {
    me->is_blocked = false;
    task_.clock_ms = now_ms_;
    if (me->check == me->after && !begin_move()) end_turn();
  } else if (me->to_its_end) {
    end_move();
  }
}

void Machine::end_turn() {
  TaskRecord* const me = tasks_.records + tasks_.me;
  me->pc = task_.pc;
  me->clock_ms = task_.clock_ms;
  if (task_.looped < me->looped_at || task_.called < me->called_at) fail();
  me->looped = static_cast<uint8_t>(task_.looped - me->looped_at);
  me->called = static_cast<uint8_t>(task_.called - me->called_at);
  tasks_.is_in_turn = false;
  task_.wait = Wait::kNothing;
  status_ = Status::kRunning;
  if (tasks_.is_first) {
    tasks_.is_first = false;
    for (uint8_t rank = 0; rank < tasks_.me; rank++) tasks_.records[rank].clock_ms = now_ms_;
  }
  pass_on();
}

// Ends the turn before the instruction at `task_.pc`.
bool Machine::pause() {
  task_.wait = Wait::kPause;
  return false;
}

// Goes back to the start of a loop, where a task that has not waited since it last did so waits.
bool Machine::goes_back() {
  TaskRecord* const me = tasks_.records + tasks_.me;
  if (!me->has_waited) {
    begin();
    sleep(task_.clock_ms + 1, Wait::kPause);
  }
  const bool goes_on = task_.wait == Wait::kNothing;
  me->has_waited = false;
  return goes_on;
}

// Goes on in a WHEN, or looks once more.
bool Machine::look(bool holds) {
  if (holds) return true;
  TaskRecord* const me = tasks_.records + tasks_.me;
  me->keeps = false;
  forget_set(me);
  return look_again();
}

bool Machine::look_again() {
  task_.pc = tasks_.records[tasks_.me].start;
  return wait(kCheckMs, Wait::kPause);
}

// Ends this task. Returns whether it was the last one.
bool Machine::ends_program() {
  TaskRecord* const me = tasks_.records + tasks_.me;
  me->has_ended = true;
  forget_set(me);
  stay();  // behind the last END lies nothing
  for (uint8_t rank = 0; rank < tasks_.count; rank++) {
    if (!tasks_.records[rank].has_ended) return pause();
  }
  return true;
}

// -- moves ----------------------------------------------------------------------------------------

void Machine::keep_move(uint32_t move_ms, bool has_powers) {
  TaskRecord* const me = tasks_.records + tasks_.me;
  me->rest_ms = move_ms;
  me->has_powers = has_powers;
  me->left = task_.left;
  me->right = task_.right;
  me->check = task_.pc;
  me->has_begun = false;
}

bool Machine::drive_in_task(uint32_t move_ms) {
  keep_move(move_ms, true);
  tasks_.records[tasks_.me].after = task_.pc;
  return is_below() ? block() : begin_move();
}

bool Machine::watch_in_task(uint32_t move_ms, bool has_powers) {
  keep_move(move_ms, has_powers);
  tasks_.records[tasks_.me].after = 0;
  return !has_powers || !is_below() || block();
}

bool Machine::until_in_task(bool stop) {
  TaskRecord* const me = tasks_.records + tasks_.me;
  me->after = task_.pc;
  if (stop) {
    if (me->has_begun) task_.clock_ms = now_ms_;
    if (me->drives) {
      end_move();
    } else if (me->is_moving) {  // it waited for the motors, or stood still
      end_move_of(me);
    }
    return true;
  }
  if (!me->has_begun) {
    if (me->has_powers && is_below()) return block();
    begin_watched();
  }
  const uint32_t gone_ms = now_ms_ - task_.clock_ms;
  const uint32_t next_ms = gone_ms - gone_ms % kCheckMs + kCheckMs;
  const bool is_last = next_ms >= me->rest_ms;  // never kForever
  if (!is_last) task_.pc = me->check;
  return drive_on(is_last ? me->rest_ms : next_ms, is_last);
}

// Begins a move that no UNTIL watches.
bool Machine::begin_move() {
  begin_watched();
  return drive_on(tasks_.records[tasks_.me].rest_ms, true);
}

void Machine::begin_watched() {
  TaskRecord* const me = tasks_.records + tasks_.me;
  if (me->has_powers) {
    take();
    forget_set(me);
    me->is_moving = me->drives = true;
    set_motors(me->left, me->right);
  }
  me->has_begun = true;
  begin();
}

// Waits, and goes on at `task_.pc`. `is_last`: the end of the wait is the end of the move.
bool Machine::drive_on(uint32_t step_ms, bool is_last) {
  TaskRecord* const me = tasks_.records + tasks_.me;
  if (me->rest_ms != kForever) me->rest_ms -= step_ms;
  me->to_its_end = is_last && me->drives;
  if (step_ms != 0) return sleep(task_.clock_ms + step_ms, Wait::kPause);
  if (me->drives) end_move();
  return true;
}

void Machine::end_move() {
  end_move_of(tasks_.records + tasks_.me);
  set_motors(0, 0);
}

// Waits for the motors.
bool Machine::block() {
  TaskRecord* const me = tasks_.records + tasks_.me;
  forget_set(me);
  me->is_moving = me->is_blocked = me->has_waited = true;
  me->drives = false;
  me->keeps = me->is_when;
  task_.pc = me->check;
  return pause();
}

// -- the motors -----------------------------------------------------------------------------------

void Machine::motors_in_task(int8_t left, int8_t right) {
  TaskRecord* const me = tasks_.records + tasks_.me;
  me->set_left = left;
  me->set_right = right;
  me->has_set = true;
  me->keeps = me->is_when;
  if (is_below()) return;
  take();
  set_motors(left, right);
}

void Machine::stop_in_task() {
  TaskRecord* const me = tasks_.records + tasks_.me;
  forget_set(me);
  me->keeps = me->is_when;
  if (is_below()) return;
  set_motors(0, 0);
  if (tasks_.holder != kNobody) {
    TaskRecord* const holder = tasks_.records + tasks_.holder;
    forget_set(holder);
    if (holder->drives) {
      end_move_of(holder);
      holder->clock_ms = now_ms_;
    }
  }
}

// Whether a higher task has the motors.
bool Machine::is_below() const { return tasks_.holder < tasks_.me; }

// Gives the motors to the task whose turn it is; no higher one has them.
void Machine::take() {
  if (tasks_.holder != kNobody && tasks_.holder != tasks_.me) {
    TaskRecord* const holder = tasks_.records + tasks_.holder;
    if (holder->drives) stand_still(holder, now_ms_);
  }
  tasks_.holder = tasks_.me;
  tasks_.records[tasks_.me].keeps = tasks_.records[tasks_.me].is_when;
}

// Behind a turn: gives the motors to the highest task that wants them, if it is another.
void Machine::pass_on() {
  uint8_t rank = 0;
  while (rank < tasks_.count && !tasks_.records[rank].wants_motors()) rank++;
  TaskRecord* const highest = tasks_.records + rank;
  const bool is_there = rank < tasks_.count;
  if (!is_there) rank = kNobody;
  if (rank == tasks_.holder) return;
  tasks_.holder = rank;
  if (is_there && highest->is_blocked) highest->clock_ms = now_ms_ + tasks_.is_first_round;
  const int8_t left = is_there ? highest->set_left : int8_t{0};
  const int8_t right = is_there ? highest->set_right : int8_t{0};
  if (left != tasks_.left || right != tasks_.right) set_motors(left, right);
}

void Machine::set_motors(int8_t left, int8_t right) {
  tasks_.left = left;
  tasks_.right = right;
  robot_motors(left, right);
}

}  // namespace tiniscript

#endif
