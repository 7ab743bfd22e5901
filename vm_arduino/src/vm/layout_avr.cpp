// Asserts that a machine lies in memory as `layout_avr.h` tells the assembly.

#include "build.h"

#ifdef tiniscript_in_assembly

#include <stddef.h>

#include "layout_avr.h"
#include "machine.h"

namespace tiniscript {

#define lies_at(member, place) static_assert(offsetof(Machine, member) == place, #member)

void Machine::check_layout() {
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
  static_assert(offsetof(TaskRecord, clock_ms) == tini_clock_at, "clock_ms");
}

#undef lies_at

}  // namespace tiniscript

#endif
