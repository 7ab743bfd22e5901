#include "vm.h"

#include <stddef.h>

#include "../robot.h"
#include "number.h"
#include "small.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLateMs = 20;  // later than this, a program's own clock no longer catches up

}  // namespace

void Machine::start(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
                    uint32_t seed, uint32_t now_ms) {
  constexpr uint8_t kUsed = offsetof(Machine, task_) + offsetof(Task, stack);
  clear(this, kUsed / 4 + 1);  // all behind that is written before it is read
  sensors_ = sensors < kDevices ? sensors : kDevices;
  readings_ = readings;
  length_ = length;
  code_ = code;
  task_.random = seed;
  task_.started_ms = now_ms;
  task_.clock_ms = now_ms;
}

Status Machine::tick(uint32_t now_ms, uint8_t budget) {
  left_ = budget;
  if (status_ >= Status::kDone) return status_;
  now_ms_ = now_ms;
  if (task_.wait != Wait::kNothing) {
    if (static_cast<int32_t>(now_ms - task_.clock_ms) < 0) return Status::kWaiting;
    if (task_.wait == Wait::kMove) robot_motors(0, 0);
    task_.wait = Wait::kNothing;
  }
  status_ = Status::kRunning;
  execute(budget);
  if (fault_ != Fault::kNone) {
    robot_off();
    status_ = Status::kFault;
  }
  return status_;
}

// Begins a wait where the one before ended, or now where that is too long ago.
tini_noinline void Machine::wait(uint32_t duration_ms, Wait what) {
  begin();
  sleep(task_.clock_ms + duration_ms, what);
}

tini_noinline void Machine::sleep(uint32_t wake_ms, Wait what) {
  task_.clock_ms = wake_ms;
  task_.wait = what;
  status_ = Status::kWaiting;
}

// Sets the program's clock to when a wait or a move that comes now begins.
tini_noinline void Machine::begin() {
  if (now_ms_ - task_.clock_ms > kLateMs) task_.clock_ms = now_ms_;
}

// Ends the watched move.
tini_noinline void Machine::finish() {
  if (!task_.is_watching) return;
  task_.clock_ms = now_ms_;
  if (task_.drives) robot_motors(0, 0);
}

// Goes on with the watched move: begins it, or waits for its next check. Returns whether there is
// one.
tini_noinline bool Machine::watch() {
  if (!task_.is_watching) {
    task_.is_watching = true;
    begin();
    task_.begun_ms = task_.clock_ms;
    if (task_.drives) robot_motors(task_.left, task_.right);
  }
  const uint32_t gone_ms = now_ms_ - task_.begun_ms;
  uint32_t next_ms =
      gone_ms - remainder(gone_ms, kCheckMs) + kCheckMs;  // never as much as kForever
  const bool is_checked = next_ms < task_.move_ms;
  if (!is_checked) next_ms = task_.move_ms;
  sleep(task_.begun_ms + next_ms, is_checked || !task_.drives ? Wait::kPause : Wait::kMove);
  return is_checked;
}

}  // namespace tiniscript
