#include "vm.h"

#include "../robot.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLateMs = 20;  // later than this, a program's own clock no longer catches up
}  // namespace

void Machine::start(const uint8_t* code, uint16_t length, uint8_t sensors, uint32_t seed,
                    uint32_t now_ms) {
  *this = Machine();  // all members are 0
  sensors_ = sensors < kDevices ? sensors : kDevices;
  length_ = length;
  code_ = code;
  now_ms_ = now_ms;
  task_.random = seed;
  task_.started_ms = now_ms;
  task_.clock_ms = now_ms;
  task_.wake_ms = now_ms;
}

Status Machine::tick(uint32_t now_ms, uint16_t budget) {
  left_ = budget;
  if (status_ >= Status::kDone) return status_;
  now_ms_ = now_ms;
  if (task_.wait != Wait::kNothing) {
    if (static_cast<int32_t>(now_ms - task_.wake_ms) < 0) return Status::kWaiting;
    if (task_.wait == Wait::kMove) robot_motors(0, 0);
    task_.wait = Wait::kNothing;
  }
  status_ = Status::kRunning;
  must_stop_ = false;
  execute();
  if (fault_ != Fault::kNone) {
    robot_off();
    status_ = Status::kFault;
  }
  return status_;
}

// Begins a wait where the one before ended, or now where that is too long ago.
__attribute__((noinline)) void Machine::wait(uint32_t duration_ms, Wait what) {
  begin();
  sleep(task_.clock_ms + duration_ms, what);
}

__attribute__((noinline)) void Machine::sleep(uint32_t wake_ms, Wait what) {
  task_.clock_ms = wake_ms;
  task_.wake_ms = wake_ms;
  task_.wait = what;
  status_ = Status::kWaiting;
  must_stop_ = true;
}

// Sets the program's clock to when a wait or a move that comes now begins.
__attribute__((noinline)) void Machine::begin() {
  if (now_ms_ - task_.clock_ms > kLateMs) task_.clock_ms = now_ms_;
}

// Ends the watched move or goes on with it, and checks again at the offset `check`.
void Machine::until(bool stop, uint16_t check) {
  if (stop) {
    if (task_.is_watching) {
      task_.clock_ms = now_ms_;
      if (task_.drives) robot_motors(0, 0);
    }
    return;
  }
  if (!task_.is_watching) {
    task_.is_watching = true;
    begin();
    task_.begun_ms = task_.clock_ms;
    if (task_.drives) robot_motors(task_.left, task_.right);
  }
  const uint32_t gone_ms = now_ms_ - task_.begun_ms;
  uint32_t next_ms = gone_ms - gone_ms % kCheckMs + kCheckMs;  // never as much as kForever
  Wait what = Wait::kPause;
  if (next_ms >= task_.move_ms) {
    next_ms = task_.move_ms;
    if (task_.drives) what = Wait::kMove;
  } else {
    task_.pc = check;
  }
  sleep(task_.begun_ms + next_ms, what);
}

// Runs this instruction again at the next tick: the robot is not ready.
__attribute__((noinline)) void Machine::retry() {
  task_.pc = at_;
  task_.depth = depth_;
  must_stop_ = true;
}

// Stops the program, unless `fault` is kNone. The first fault stays.
void Machine::raise(Fault fault) {
  if (fault == Fault::kNone || fault_ != Fault::kNone) return;
  fault_ = fault;
  must_stop_ = true;
}

}  // namespace tiniscript
