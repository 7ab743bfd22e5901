// Asserts that a machine lies in memory as `layout_avr.h` tells the assembly, and has its numbers: those
// of tasks also where a machine has none.

#include "build.h"

#ifdef tiniscript_in_assembly

#include <stddef.h>

#include "layout_avr.h"
#include "machine.h"

namespace tiniscript {

#define lies_at(member, place) static_assert(offsetof(Machine, member) == place, #member)
#define lies_in_task(member, place) \
  static_assert(offsetof(Machine, task_) + offsetof(TaskOf<true>, member) == place, #member)
#define lies_in_record(member, place) \
  static_assert(offsetof(TaskRecord, member) == place, #member)
#define is_bit(mask, bit) static_assert(mask == 1 << bit, #mask)

void Machine::check_layout() {
  lies_at(status_, 0);
  lies_at(fault_, tini_fault_at);
  lies_at(sensors_, tini_sensors_at);
  lies_at(offset_, tini_at_at);
  lies_at(budget_left_, tini_budget_left_at);
  lies_at(length_, tini_length_at);
  lies_at(code_, tini_code_at);
  lies_at(readings_, tini_readings_at);
  lies_at(now_ms_, tini_now_at);
  lies_at(task_.pc, tini_pc_at);
  lies_at(task_.depth, tini_depth_at);
  lies_at(task_.frame_count, tini_frame_count_at);
  lies_at(task_.variables, tini_variables_at);
  lies_at(task_.stack, tini_stack_at);
  lies_at(task_.frames, tini_frames_at);
  lies_in_task(other_tasks, tini_other_tasks_at);
  lies_in_task(is_quiet, tini_is_quiet_at);
  lies_in_task(current, tini_current_at);
  lies_in_task(move_end, tini_move_end_at);
  lies_in_task(holder, tini_holder_at);
  static_assert(offsetof(TaskOf<true>, records) - offsetof(TaskOf<true>, variables) ==
                    tini_records_at - tini_variables_at, "records");
  lies_in_record(state, 0);
  lies_in_record(code, tini_task_code_at);
  lies_in_record(power, tini_task_power_at);
  lies_in_record(frame_count, tini_task_frame_count_at);
  lies_in_record(pc, tini_task_pc_at);
  lies_in_record(start, tini_task_start_at);
  lies_in_record(check, tini_task_check_at);
  lies_in_record(clock_ms, tini_clock_at);
  lies_in_record(rest_ms, tini_task_rest_at);
  lies_in_record(own_powers, tini_task_own_powers_at);
  static_assert(sizeof(TaskRecord) == tini_record_bytes, "TaskRecord");
  is_bit(kIsMoving, tini_is_moving_bit);
  is_bit(kHasTime, tini_has_time_bit);
  is_bit(kDrives, tini_drives_bit);
  is_bit(kToItsEnd, tini_to_its_end_bit);
  is_bit(kHasBegun, tini_has_begun_bit);
  is_bit(kHoldsPowers, tini_holds_powers_bit);
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
}

#undef is_bit
#undef lies_in_record
#undef lies_in_task
#undef lies_at

}  // namespace tiniscript

#endif
