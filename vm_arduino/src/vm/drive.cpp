// Waits and moves of tasks, and who has the motors. `tasks_avr.S` is the same for an Uno without discs.

#include "build.h"

#ifdef tiniscript_drives_in_turns

#include "../robot.h"
#include "drive.h"

namespace tiniscript {

namespace {

// The task whose move the robot measures, or measured last, unless its move is over: the robot
// measures one at a time.
TaskRecord* measured_task;

void forget_set(TaskRecord* task) { task->state &= static_cast<uint8_t>(~kHoldsPowers); }

// Its M is over; a WHEN goes on wanting the motors.
tini_noinline void want(TaskRecord* task) {
  uint8_t state = static_cast<uint8_t>(task->state & ~kHoldsPowers);
  if (task->start != 0) state |= kKeeps;
  task->state = state;
}

// Its move is over, and so is its M.
void end_move_of(TaskRecord* task) {
  task->state &= static_cast<uint8_t>(~(kHoldsPowers | kIsMoving | kDrives | kToItsEnd));
}

}  // namespace

// Keeps the move or wait that an UNTIL watches; its check begins after this instruction.
tini_noinline void Drive::keep_move(uint32_t move_ms) {
  TaskRecord* const task = task_.current;
  task->rest_ms = move_ms;
  task->check = task_.pc;
  task->state &= static_cast<uint8_t>(~kHasBegun);
  if (measured_task == task) measured_task = nullptr;
}

// Whether a higher task has the motors.
inline bool Drive::is_below() const { return task_.holder < task_.current; }

void Drive::forget_way() { measured_task = nullptr; }

// Ends a move that drives, of whatever task. It goes on after the move, and after its UNTIL.
tini_noinline void Drive::leave_move(TaskRecord* task) {
  if (!task->is(kToItsEnd)) task->pc = task_.move_end;
  end_move_of(task);
}

// A move that drives loses the motors.
inline void Drive::stand_still(TaskRecord* task) {
  if (task->measures()) {
    int32_t remaining;
    if (robot_move_state(&remaining) == MoveState::kArrived || remaining <= 0)
      return leave_move(task);
  } else if (!task->is_forever()) {
    const uint32_t left_ms = task->rest_ms - late_ms(task);
    if (static_cast<int32_t>(left_ms) <= 0) return leave_move(task);
    task->rest_ms = left_ms;
  }
  task->state &= static_cast<uint8_t>(~(kHasTime | kDrives | kHasBegun | kToItsEnd));
  task->pc = task->check;
}

// A wait is a move that leaves the motors as they are. One of 0 ms ends no turn of a task.
bool Drive::wait(uint32_t duration_ms) {
  task_.current->code = static_cast<uint8_t>(Op::kWait);
  return drive(duration_ms);
}

tini_noinline bool Drive::drive(uint32_t move_ms) {
  keep_move(move_ms);
  return !blocks() && go_on();
}

// Begins to watch a move or a wait.
bool Drive::watch(uint32_t move_ms) {
  keep_move(move_ms);
  task_.current->code |= TaskRecord::kWatches;
  return !blocks();
}

// Continues or ends the watched move, as its UNTIL says.
bool Drive::until(bool stop) {
  TaskRecord* const task = task_.current;
  if (!stop) return go_on();
  if (task->is(kHasBegun)) set_clock(task);
  task->state |= kHasBegun;
  if (task->is(kIsMoving)) end_move();
  return true;
}

// Begins a move where it has not begun, which it may now, and waits for its end, or for the next
// check of its UNTIL. Returns whether the next instruction may run now.
tini_noinline bool Drive::go_on() {
  TaskRecord* const task = task_.current;
  const bool is_watched = task->is_watched();
  const bool measures = task->measures();
  if (!task->is(kHasBegun)) {
    if (task->is_move()) {
      take_motors();
      task->state |= kIsMoving | kDrives;
      if (measures) {
        go_way();
      } else {
        set_motors(powers_of_move(task));
      }
    }
    task->state |= kHasBegun;
    begin(task);
  }
  if (measures && !continues_way()) {
    task->clock_ms = now_ms_;
    return fault_ == Fault::kNone;
  }
  uint32_t due_ms = measures ? kForever : task->rest_ms;
  bool looks_back = false;
  if (is_watched || measures) {
    const uint32_t next_ms = next_check_ms(task);
    if (next_ms < due_ms) {
      due_ms = next_ms;
      looks_back = is_watched;
    }
  }
  if (task->is(kDrives)) {
    if (looks_back) {
      task_.move_end = task_.pc;
    } else {
      task->state |= kToItsEnd;
    }
  }
  if (looks_back) task_.pc = task->check;
  if (due_ms == 0 && has_tasks()) {
    if (task->is(kToItsEnd)) end_move();
    return true;
  }
  if (!measures && !task->is_forever()) task->rest_ms -= due_ms;
  task->clock_ms += due_ms;
  task->state |= kHasWaited;
  return pause();
}

// Lets the robot go a way that it measures, or go on with it. It knows one: before it goes
// another, it is asked for the rest of that.
void Drive::go_way() {
  TaskRecord* const task = task_.current;
  const Powers powers = task->own_powers = powers_of_move(task);
  const int8_t left = static_cast<int8_t>(powers);
  const int8_t right = static_cast<int8_t>(powers >> 8);
  if (measured_task == task) return robot_go_on(left, right);
  if (measured_task != nullptr && measured_task->is(kIsMoving)) {
    int32_t remaining = 0;
    robot_move_state(&remaining);
    measured_task->rest_ms = static_cast<uint32_t>(remaining);
  }
  measured_task = task;
  robot_go(left, right, static_cast<int32_t>(task->rest_ms));
}

// False: it is there, and its move is over, or a wheel does not turn.
bool Drive::continues_way() {
  constexpr uint8_t kGoBytes = 2;
  static_assert(static_cast<Fault>(MoveState::kStuckRight) == Fault::kStuckRight, "a Fault");
  int32_t remaining;
  const MoveState state = robot_move_state(&remaining);
  if (state == MoveState::kMoving) return true;
  if (state == MoveState::kArrived) {
    end_move();
    return false;
  }
  offset_ = static_cast<uint16_t>(task_.current->check - kGoBytes);  // an UNTIL sets its own later
  return goes_on(static_cast<Fault>(state));
}

// At the end of a move, or at a look at one that is measured. False: it goes on.
tini_noclone bool Drive::comes_to_end() {
  if (task_.current->measures()) return go_on();
  end_move();
  return true;
}

// Ends the move of the task whose turn it is: it drives, or it waited for the motors or stood
// still.
tini_noinline void Drive::end_move() {
  TaskRecord* const task = task_.current;
  const bool was_driving = task->is(kDrives);
  end_move_of(task);
  if (was_driving) set_motors(kMotorsOff);
}

// Waits for the motors where its move needs them and a higher task has them.
tini_noinline bool Drive::blocks() {
  TaskRecord* const task = task_.current;
  if (!task->is_move() || !is_below()) return false;
  want(task);
  task->state = static_cast<uint8_t>((task->state & ~kHasTime) | kIsMoving | kHasWaited);
  task_.pc = task->check;
  return !pause();
}

void Drive::motors(Powers powers) {
  if (is_below()) {
    want(task_.current);
  } else {
    take_motors();
    set_motors(powers);
  }
  task_.current->own_powers = powers;
  task_.current->state |= kHoldsPowers;
}

void Drive::stop_motors() {
  want(task_.current);
  if (is_below()) return;
  set_motors(kMotorsOff);
  TaskRecord* const holder = task_.holder;
  forget_set(holder);
  if (!holder->is(kDrives)) return;
  leave_move(holder);
  set_clock(holder);
}

// Gives the motors to the task whose turn it is; no higher one has them.
tini_noinline void Drive::take_motors() {
  want(task_.current);
  TaskRecord* const holder = task_.holder;
  task_.holder = task_.current;
  if (holder->is(kDrives)) stand_still(holder);
}

// For a robot without discs.
__attribute__((weak)) bool robot_measures() { return false; }
__attribute__((weak)) void robot_go(int8_t, int8_t, int32_t) {}
__attribute__((weak)) MoveState robot_move_state(int32_t*) { return MoveState::kArrived; }
__attribute__((weak)) void robot_go_on(int8_t left, int8_t right) {
  int32_t remaining = 0;
  robot_move_state(&remaining);
  robot_go(left, right, remaining);
}

}  // namespace tiniscript

#endif
