#include "vm.h"

#include <stddef.h>

#include "../robot.h"
#include "execute_avr.h"
#include "number.h"
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
  task_.random = seed;
  task_.started_ms = now_ms;
#ifdef tiniscript_has_tasks
  find_tasks();
#endif
#ifdef tiniscript_has_discs
  on_way_ = nullptr;
#endif
  task_.me->clock_ms = now_ms;
}

uint32_t Machine::wake_ms() const {
#ifdef tiniscript_has_tasks
  if (has_tasks()) return next_turn_ms();
#endif
  return task_.me->clock_ms;
}

// Whether the time has come for a round: in each millisecond there is one at least, which takes less
// flash than to find out when the next turn is.
inline bool Machine::is_due() const {
#ifdef tiniscript_has_tasks
  if (has_tasks()) return !task_.is_quiet;
#endif
  return static_cast<int32_t>(late_ms(task_.me)) >= 0;
}

// Ends a wait. False: it goes on.
bool Machine::may_go_on(uint32_t now_ms) {
#ifdef tiniscript_has_tasks
  if (now_ms_ != now_ms) task_.is_quiet = false;
#endif
  now_ms_ = now_ms;
  // No wait is longer than that, so no tick skips the whole second half of the clock.
  if (static_cast<int32_t>(now_ms - task_.started_ms) < 0) task_.is_late = true;
  if (status_ == Status::kWaiting) {
    if (!is_due()) return false;
    status_ = Status::kRunning;
    if (!has_tasks() && task_.me->is(kToItsEnd) && !comes_to_end()) return false;
  }
  return true;
}

Status Machine::tick(uint32_t now_ms, uint8_t budget) {
  left_ = budget;
  if (status_ >= Status::kDone || budget == 0) return status_;
  if (kHasDiscs && fault_ != Fault::kNone) {
  } else if (!may_go_on(now_ms)) {
    if (!kHasDiscs || fault_ == Fault::kNone) return Status::kWaiting;
  } else if (has_tasks()) {
    run_round();
  } else {
    execute(budget);
  }
  if (fault_ != Fault::kNone) {
    robot_off();
    status_ = Status::kFault;
  }
  return status_;
}

bool Machine::goes_on(Fault fault) {
  fault_ = fault;
  return fault == Fault::kNone;
}

// A run-time check has failed, which verified code never causes.
bool Machine::fail() { return goes_on(Fault::kBadCode); }

#ifdef tiniscript_in_assembly

// The layout that `execute_avr.S` relies on.
#define lies_at(member, place) static_assert(offsetof(Machine, member) == place, #member)
#define lies_in_record(member, place) \
  static_assert(offsetof(TaskRecord, member) == place, #member)
#define is_bit(mask, bit) static_assert(mask == 1 << bit, #mask)

void Machine::check_places() {
  lies_at(fault_, tini_fault_at);
  lies_at(sensors_, tini_sensors_at);
  lies_at(at_, tini_at_at);
  lies_at(left_, tini_left_at);
  lies_at(length_, tini_length_at);
  lies_at(code_, tini_code_at);
  lies_at(readings_, tini_readings_at);
  lies_at(now_ms_, tini_now_at);
  lies_at(task_.pc, tini_pc_at);
  lies_at(task_.depth, tini_depth_at);
  lies_at(task_.framed, tini_framed_at);
  lies_at(task_.variables, tini_variables_at);
  lies_at(task_.stack, tini_stack_at);
  lies_at(task_.frames, tini_frames_at);
  lies_in_record(clock_ms, tini_clock_at);
#ifdef tiniscript_has_tasks
  lies_at(status_, 0);
  lies_at(task_.others, tini_others_at);
  lies_at(task_.is_quiet, tini_is_quiet_at);
  lies_at(task_.me, tini_me_at);
  lies_at(task_.after, tini_after_at);
  lies_at(task_.holder, tini_holder_at);
  lies_at(task_.records, tini_records_at);
  lies_in_record(state, 0);
  lies_in_record(code, tini_task_code_at);
  lies_in_record(power, tini_task_power_at);
  lies_in_record(framed, tini_task_framed_at);
  lies_in_record(pc, tini_task_pc_at);
  lies_in_record(start, tini_task_start_at);
  lies_in_record(check, tini_task_check_at);
  lies_in_record(rest_ms, tini_task_rest_at);
  lies_in_record(set, tini_task_set_at);
  static_assert(sizeof(TaskRecord) == tini_record_bytes, "TaskRecord");
  is_bit(kIsMoving, tini_is_moving_bit);
  is_bit(kHasTime, tini_has_time_bit);
  is_bit(kDrives, tini_drives_bit);
  is_bit(kToItsEnd, tini_to_its_end_bit);
  is_bit(kHasBegun, tini_has_begun_bit);
  is_bit(kHasSet, tini_has_set_bit);
  is_bit(kKeeps, tini_keeps_bit);
  is_bit(kHasWaited, tini_has_waited_bit);
  is_bit(kHasHadTurn, tini_has_had_turn_bit);
  is_bit(TaskRecord::kWaits, tini_waits_bit);
  is_bit(TaskRecord::kWatches, tini_watches_bit);
  static_assert(kWantsMotors == tini_wants_motors, "kWantsMotors");
  static_assert(kIsFirstRound == tini_is_first_round, "kIsFirstRound");
  static_assert(kTasks == tini_tasks, "kTasks");
  static_assert(Status::kRunning == static_cast<Status>(0), "kRunning");
  static_assert(Status::kWaiting == static_cast<Status>(tini_waiting), "kWaiting");
  static_assert(Status::kDone == static_cast<Status>(tini_done), "kDone");
  static_assert(TaskRecord::kFirstShow == tini_show, "kShow");
  static_assert(Op::kWait == static_cast<Op>(tini_wait), "kWait");
  static_assert(kCheckMs == tini_check_ms && kLateMs == tini_late_ms, "times");
  static_assert(Op::kCall == static_cast<Op>(tini_call), "kCall");
#endif
}

#undef is_bit
#undef lies_at

#endif

}  // namespace tiniscript
