#include "machine.h"

#include <stddef.h>

#include "../robot.h"
#include "small.h"

namespace tiniscript {

void Machine::start(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
                    uint32_t seed, uint32_t now_ms) {
  prepare();
  start_prepared(code, length, readings, sensors, seed, now_ms);
}

void Machine::prepare() {
  constexpr uint16_t kUsed = offsetof(Machine, task_) + offsetof(Task, stack);
  clear(this, kUsed / 4 + 1);  // everything after that is written before it is read
}

void Machine::start_prepared(const uint8_t* code, uint16_t length, int32_t* readings,
                             uint8_t sensors, uint32_t seed, uint32_t now_ms) {
  sensors_ = sensors < kDevices ? sensors : kDevices;
  readings_ = readings;
  length_ = length;
  code_ = code;
  task_.random_state = seed;
  task_.started_ms = now_ms;
  if (kHasTasks) find_tasks();
  if (kHasDiscs) forget_way();
  task_.current->clock_ms = now_ms;
}

uint32_t Machine::wake_ms() const {
  return has_tasks() ? Scheduler::wake_ms() : task_.current->clock_ms;
}

// Whether it is time for a round: each millisecond has at least one, which takes less flash than
// finding out when the next turn is.
inline bool Machine::is_due() const {
  if (has_tasks()) return !task_.is_quiet;
  return static_cast<int32_t>(late_ms(task_.current)) >= 0;
}

bool Machine::wake(uint32_t now_ms) {
  if (kHasTasks && now_ms_ != now_ms) task_.end_quiet();
  now_ms_ = now_ms;
  // No wait is longer than that, so no tick skips the whole second half of the clock.
  if (static_cast<int32_t>(now_ms - task_.started_ms) < 0) task_.is_late = true;
  if (status_ == Status::kWaiting) {
    if (!is_due()) return false;
    status_ = Status::kRunning;
    if (!has_tasks() && task_.current->is(kToItsEnd) && !comes_to_end()) return false;
  }
  return true;
}

Status Machine::tick(uint32_t now_ms, uint8_t budget) {
  budget_left_ = budget;
  if (status_ >= Status::kDone || budget == 0) return status_;
  if (!is_stuck() && wake(now_ms)) {
    if (has_tasks()) {
      run_round();
    } else {
      execute(budget);
    }
  } else if (!is_stuck()) {
    return Status::kWaiting;
  }
  return fault_ == Fault::kNone ? status_ : end_in_fault();
}

Status Machine::end_in_fault() {
  if (is_trapped()) return status_ = Status::kHalted;
  robot_off();
  return status_ = Status::kFault;
}

}  // namespace tiniscript
