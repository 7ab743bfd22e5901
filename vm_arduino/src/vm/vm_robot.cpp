// Instructions that use the robot, the clock or random numbers: the same on every chip.

#include "../robot.h"
#include "number.h"
#include "shape.h"
#include "small.h"
#include "vm.h"

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
tini_noinline int16_t limited(int32_t value, int16_t low, int16_t high) {
  const int16_t part = static_cast<int16_t>(value);
  if (part != value) return value < 0 ? low : high;
  return part < low ? low : part > high ? high : part;
}

// A power in percent, from `low` to 100.
tini_noinline int8_t percent(int32_t power, int8_t low) {
  return static_cast<int8_t>(limited(whole(power), low, 100));
}

}  // namespace

// Takes a reading. Returns false if the robot is not ready or has no such sensor.
bool Machine::sense(uint8_t number) {
  if (number >= sensors_) return fail();
  return robot_read(number, readings_ + number);
}

// Keeps the powers of a move. The last two bits of its code are the direction: F, B, L, R.
tini_noinline void Machine::powers(uint8_t code, int8_t power) {
  const uint8_t way = code & 3;
  const int8_t reversed = static_cast<int8_t>(-power);
  task_.me->powers =
      powers_of(way == 1 || way == 2 ? reversed : power, way == 1 || way == 3 ? reversed : power);
}

// Shows a value. Where there is no room a task keeps it and ends its turn, so that nothing stays on
// the stack; a program without tasks waits for room, and so does the main task before all others.
inline bool Machine::show(int32_t value, bool is_yes_no) {
#ifdef tiniscript_has_tasks
  task_.me->rest_ms = static_cast<uint32_t>(value);
  task_.me->more = static_cast<uint8_t>(kUnsent | is_yes_no);
  return sends() || (has_tasks() && task_.is_later_turn ? pause() : stay());
#else
  return robot_show(value, is_yes_no) || stay();
#endif
}

// Puts into `*time_ms` how long it takes to go or to turn that way: `way` * 100000 / its speed,
// rounded half away from zero. False: it never comes there, or not in time.
//
// It multiplies bit by bit and keeps the rest of the division, so that nothing has more than 32
// bits: a speed is at most 10^9.
bool Machine::go_ms(uint8_t code, int8_t power, int32_t way, uint32_t* time_ms) {
  constexpr uint32_t kMostMs = 0x7fffffff;
  constexpr uint32_t kTimes = 100000;
  *time_ms = 0;
  if (way <= 0) return true;
#ifdef tiniscript_has_discs
  if (robot_measures()) {
    task_.me->more |= kMeasures;
    *time_ms = static_cast<uint32_t>(way);
    return goes_on(power == 0 ? Fault::kNoPower : Fault::kNone);
  }
#endif
  const uint32_t divisor =
      power == 0 ? 0 : robot_speed((code & 2) != 0, static_cast<uint8_t>(power));
  if (divisor == 0) return goes_on(Fault::kNoPower);
  const uint32_t more = static_cast<uint32_t>(way) / divisor;
  const uint32_t more_rest = static_cast<uint32_t>(way) % divisor;
  uint32_t found = 0;
  uint32_t rest = 0;
  for (uint32_t bit = uint32_t{1} << 16; bit != 0; bit >>= 1) {
    const bool adds = (kTimes & bit) != 0;
    if (found > kMostMs / 2) return goes_on(Fault::kOverflow);
    found += found;
    rest += rest + (adds ? more_rest : 0);
    while (rest >= divisor) {
      rest -= divisor;
      found++;
    }
    if (adds) found += more;
    if (found > kMostMs) return goes_on(Fault::kOverflow);
  }
  if (rest >= divisor - rest) found++;
  *time_ms = found;
  return found <= kMostMs || goes_on(Fault::kOverflow);
}

// Executes the instruction `code` at `bytes`, which lies before `task_.pc`; `top` points to the top
// of the stack. Returns whether the next instruction may run now.
//
// A time is the first value that an instruction takes, a power the last one; without values they
// are its first and last operand. Both are read before the switch, which takes half as much flash.
bool Machine::act(uint8_t code, const uint8_t* bytes, int32_t* top) {
  const bool is_escaped = kHasWays && code == static_cast<uint8_t>(Op::kEscape);
  if (is_escaped) {
    code = bytes[1];
    if (!is_way(code)) return fail();
  }
  const Shape shape = shape_of(code);
  const Family family = shape.family;
  // The check of an UNTIL may contain these; its move is unchanged.
  if (family == Family::kTime) {
    *top = static_cast<int32_t>(now_ms_ - task_.started_ms);
    return !task_.is_late || goes_on(Fault::kOverflow);
  }
  if (family == Family::kRandom) {
    task_.random = next_random(task_.random);
    return goes_on(random_between(top - 1, task_.random));
  }
  if (kHasTasks && family >= Family::kLook) {
    if (family == Family::kLook) return look(*top != 0);
    if (family == Family::kEndWhen) return look_again();
  }
  const bool takes = shape.pops() != 0;
  const uint8_t first = shape.size() == 1 ? static_cast<uint8_t>(code % kShorts) : bytes[1];
  const int8_t low = family == Family::kMotors ? -100 : 0;
  const int8_t power = takes ? percent(*top, low) : signed8(bytes[shape.size() - 1]);
  uint32_t time_ms = takes ? duration(shape.pops() == 1 ? *top : top[-1]) : time8(first);
  if (kHasDiscs) task_.me->more &= static_cast<uint8_t>(~kMeasures);
  if (is_escaped && !go_ms(code, power, top[-1], &time_ms)) return false;
  switch (family) {
    case Family::kShowYesNo:
      if (*top != 0) *top = 1;
      // fallthrough
    case Family::kShow:
      return show(*top, family == Family::kShowYesNo);
    case Family::kSet:
      robot_set(first, *top);
      return true;
    case Family::kStop:
      stop_motors();
      return true;
    case Family::kMotors:
      motors(powers_of(percent(top[-1], low), power));
      return true;
    case Family::kMotors8:
      motors(powers_of(signed8(first), power));
      return true;
    case Family::kMove:
    case Family::kMove8:
      powers(code, power);
      return drive(time_ms);
    case Family::kWatchForever:
      time_ms = kForever;
      // fallthrough
    case Family::kWatch:
      powers(code, power);
      return watch(time_ms);
    case Family::kWatchForeverWait:
      time_ms = kForever;
      // fallthrough
    case Family::kWatchWait:
      task_.me->powers = kNoPowers;
      return watch(time_ms);
    case Family::kBeep:
    case Family::kBeep8: {
      const int32_t hertz = takes ? whole(*top) : static_cast<uint16_t>(bytes[2] | bytes[3] << 8);
      robot_beep(static_cast<uint16_t>(limited(hertz, 31, 20000)), time_ms);
    }
      // fallthrough
    case Family::kWait:
    case Family::kWait8:
      return wait(time_ms);
    default:  // kEnd or kEndTask: the others are in the inner loop
      if (has_tasks() && !ends_program()) return false;
      robot_off();
      status_ = Status::kDone;
      return stay();
  }
}

}  // namespace tiniscript
