// Instructions that involve the robot, the clock or chance: the same on every chip.

#include "../robot.h"
#include "decode_form.h"
#include "machine.h"
#include "number.h"
#include "small.h"

namespace tiniscript {

namespace {

int8_t signed8(uint8_t operand) { return static_cast<int8_t>(operand); }

// Milliseconds of an operand of the kind time8: hundredths of a second, tenths, whole ones.
uint32_t time8(uint8_t time) {
  if (time < 100) return static_cast<uint16_t>(time * 10);
  if (time < 200) return static_cast<uint16_t>((time - 90) * 100);
  return static_cast<uint8_t>(time - 189) * uint32_t{1000};
}

// Milliseconds: a time in thousandths of a second, not below 0.
uint32_t duration(int32_t time) { return time < 0 ? 0 : static_cast<uint32_t>(time); }

// Returns `value` limited to `low` to `high`.
tini_noinline int16_t clamp(int32_t value, int16_t low, int16_t high) {
  const int16_t part = static_cast<int16_t>(value);
  if (part != value) return value < 0 ? low : high;
  return part < low ? low : part > high ? high : part;
}

// A power in percent, from -100 to 100.
tini_noinline int8_t percent(int32_t power) {
  return static_cast<int8_t>(clamp(whole(power), -100, 100));
}

// The time of a move is not below 0.
int8_t move_power(int8_t power) { return power < 0 ? 0 : power; }

}  // namespace

void Drive::set_motors(Powers powers) {
  task_.note_powers(powers);
  robot_motors(static_cast<int8_t>(powers), static_cast<int8_t>(powers >> 8));
}

// Takes a reading. Returns false if the robot is not ready or has no such sensor.
bool Machine::sense(uint8_t number) {
  if (number >= sensors_) return fail();
  return robot_read(number, readings_ + number);
}

// Shows a value. Without room, a task keeps it and ends its turn, so that nothing stays on the
// stack; a program without tasks waits for room, and so does the main task before all others.
inline bool Machine::show(int32_t value) {
  if (!kHasTasks) return robot_show(value, task_.current->shows_yes_no()) || stay();
  task_.current->rest_ms = static_cast<uint32_t>(value);
  return sends() || (has_had_turn() ? pause() : stay());
}

// Lets the second value from the top be how long it takes to go or to turn so far. False: it never
// comes there, or not in time.
inline bool Machine::go_ms(uint8_t code, int32_t* top) {
  if (!is_way(code)) return fail();
  int32_t* const distance = top - 1;
  if (*distance <= 0) return true;
  const uint8_t power = static_cast<uint8_t>(move_power(percent(*top)));
  if (kHasDiscs && robot_measures()) {
    return goes_on(power == 0 ? Fault::kNoPower : Fault::kNone);
  }
  const int32_t speed = power == 0 ? 0 : robot_speed((code & 2) != 0, power);
  if (speed <= 0) return goes_on(Fault::kNoPower);
  *distance = static_cast<int32_t>(
      scaled(static_cast<uint32_t>(*distance), 100000, static_cast<uint32_t>(speed)));
  return *distance >= 0 || goes_on(Fault::kOverflow);
}

// Executes the instruction `code` at `bytes`, which lies before `task_.pc`; `top` points to the top
// of the stack. Returns whether the next instruction may run now.
//
// A time is the first value that an instruction takes, a power the last one; without values they
// are its first and last operand. Both are read before the switch, which takes half as much flash.
bool Machine::act(uint8_t code, const uint8_t* bytes, int32_t* top) {
  if (code == static_cast<uint8_t>(Op::kEscape)) {  // then it is a move with a time
    code = bytes[1];
    if (!go_ms(code, top)) return false;
  }
  const DecodeForm form = decode_form_of(code);
  const Family family = form.family;
  // The check of an UNTIL may contain these; its move is unchanged.
  if (family == Family::kTime) {
    *top = static_cast<int32_t>(now_ms_ - task_.started_ms);
    return !task_.is_late || goes_on(Fault::kOverflow);
  }
  if (family == Family::kRandom) {
    task_.random_state = next_random(task_.random_state);
    return goes_on(random_between(top - 1, task_.random_state));
  }
  if (kHasTasks && family >= Family::kLook) {
    if (family == Family::kLook) return look(*top != 0);
    if (family == Family::kEndWhen) return look_again();
  }
  const bool takes_values = form.pops() != 0;
  const uint8_t first = form.size() == 1 ? static_cast<uint8_t>(code % kShorts) : bytes[1];
  const int8_t power = takes_values ? percent(*top) : signed8(bytes[form.size() - 1]);
  uint32_t time_ms = takes_values ? duration(form.pops() == 1 ? *top : top[-1]) : time8(first);
  // of a move; what is neither move nor wait leaves them to the next one
  task_.current->code = code;
  task_.current->power = power;
  if (kHasDiscs && *bytes != code && time_ms != 0 && robot_measures()) {
    task_.current->code |= TaskRecord::kMeasures;
  }
  switch (family) {
    case Family::kShowYesNo:
      if (*top != 0) *top = 1;
      // fallthrough
    case Family::kShow:
      return show(*top);
    case Family::kSet:
    case Family::kSetShort:
      robot_set(first, *top);
      return true;
    case Family::kStop:
      stop_motors();
      return true;
    case Family::kMotors:
      motors(powers_of(percent(top[-1]), power));
      return true;
    case Family::kMotors8:
      motors(powers_of(signed8(first), power));
      return true;
    case Family::kWatchForever:
    case Family::kWatchForeverWait:
      time_ms = kForever;
      // fallthrough
    case Family::kWatch:
    case Family::kWatchWait:
      return watch(time_ms);
    case Family::kBeep:
    case Family::kBeep8: {
      const int32_t hertz =
          takes_values ? whole(*top) : static_cast<uint16_t>(bytes[2] | bytes[3] << 8);
      robot_beep(static_cast<uint16_t>(clamp(hertz, 31, 20000)), time_ms);
    }
      // fallthrough
    case Family::kMove:
    case Family::kMove8:
    case Family::kWait:
    case Family::kWait8:
      return drive(time_ms);
    case Family::kNone:  // these are done before, or in the inner loop
    case Family::kPushRead:
    case Family::kPushReadShort:
    case Family::kTime:
    case Family::kRandom:
    case Family::kLook:
    case Family::kEndWhen:
      break;
  }
  // kEnd or kEndTask, which have no family
  stay();  // after the last END lies nothing
  if (has_tasks() && !end_task()) return false;
  robot_off();
  status_ = Status::kDone;
  return false;
}

}  // namespace tiniscript
