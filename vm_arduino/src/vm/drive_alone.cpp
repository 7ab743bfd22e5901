// Waits and moves of a machine without tasks: nobody takes the motors away.

#include "build.h"

#ifdef tiniscript_drives_alone

#include "drive.h"

namespace tiniscript {

bool Drive::drive(uint32_t move_ms) {
  TaskRecord* const me = task_.me;
  if (me->is_move()) {
    set_motors_of_move();
    me->state = kToItsEnd;
  }
  begin(me);
  me->clock_ms += move_ms;
  return pause();
}

bool Drive::watch(uint32_t move_ms) {
  keep_move(move_ms);
  return true;
}

// Keeps the move or wait that an UNTIL watches; its check begins after this instruction.
void Drive::keep_move(uint32_t move_ms) {
  TaskRecord* const me = task_.me;
  me->rest_ms = move_ms;
  me->check = task_.pc;
  me->state &= static_cast<uint8_t>(~kHasBegun);
}

bool Drive::until(bool stop) {
  TaskRecord* const me = task_.me;
  const bool drives = me->is_move();
  if (stop) {
    if (!me->is(kHasBegun)) return true;
    me->clock_ms = now_ms_;
    if (drives) set_motors(kMotorsOff);
    return true;
  }
  if (!me->is(kHasBegun)) {
    me->state = kHasBegun;
    begin(me);
    if (drives) set_motors_of_move();
  }
  uint32_t next_ms = next_check_ms(me);
  if (next_ms < me->rest_ms) {
    task_.pc = me->check;
    if (!me->is_forever()) me->rest_ms -= next_ms;
  } else {
    next_ms = me->rest_ms;
    if (drives) me->state = kToItsEnd;
  }
  me->clock_ms += next_ms;
  return pause();
}

void Drive::end_move() {
  task_.me->state = 0;
  set_motors(kMotorsOff);
}

bool Drive::comes_to_end() {
  end_move();
  return true;
}

tini_noinline void Drive::set_motors_of_move() { set_motors(powers_of_move(task_.me)); }
void Drive::motors(Powers powers) { set_motors(powers); }
void Drive::stop_motors() { set_motors(kMotorsOff); }

}  // namespace tiniscript

#endif
