// What each instruction does: a `case` for each form in `bytecode.h`.
//
// The switch has no `default`, so the compiler names a form that is forgotten.

#include "../robot.h"
#include "number.h"
#include "small.h"
#include "vm.h"

namespace tiniscript {

namespace {

// The two operands of one byte that a word of operands is, and a number with a sign.
uint8_t low(uint16_t operand) { return static_cast<uint8_t>(operand & 0xff); }
uint8_t high(uint16_t operand) { return static_cast<uint8_t>(operand >> 8); }
int8_t signed8(uint8_t operand) { return static_cast<int8_t>(operand); }

constexpr uint8_t kTenthMs = 100;

// Milliseconds: a time in thousandths of a second, not below 0.
uint32_t duration(int32_t time) { return time < 0 ? 0 : static_cast<uint32_t>(time); }

// The number nearest to `value` from `low` to `high`.
tini_noinline int16_t limited(int32_t value, int16_t low, int16_t high) {
  const int16_t part = static_cast<int16_t>(value);
  if (part != value) return value < 0 ? low : high;
  return part < low ? low : part > high ? high : part;
}

// A power in percent, from `low` to 100.
int8_t percent(int32_t power, int8_t low) {
  return static_cast<int8_t>(limited(whole(power), low, 100));
}

}  // namespace

// Takes a reading where it `must_read`, else leaves the kept one. Returns false where the robot is
// not ready, or does not have the sensor.
tini_noinline bool Machine::sense(uint8_t number, bool must_read) {
  if (number >= sensors_) return fail();
  return !must_read || robot_read(number, readings_ + number);
}

// MOVE to WATCH_FOREVER and WAIT to WATCH_FOREVER_WAIT. Each comes in four forms: with a time from
// the stack, with bytes, watched, and watched forever. Returns whether the program waits now.
tini_noinline bool Machine::move(uint8_t code, uint16_t operand, const int32_t* values) {
  const bool drives = code < static_cast<uint8_t>(Op::kWait);
  const uint8_t form = (drives ? code >> 2 : code) & 3;
  uint32_t move_ms = kForever;
  if (form == 1) {
    move_ms = static_cast<uint16_t>(low(operand) * kTenthMs);
  } else if (form != 3) {
    move_ms = duration(*values++);
  }
  if (drives) {
    const int8_t power = form == 1 ? signed8(high(operand)) : percent(*values, 0);
    // the last two bits say which way: F, B, L, R
    const uint8_t way = code & 3;
    const int8_t reversed = static_cast<int8_t>(-power);
    task_.left = way == 1 || way == 2 ? reversed : power;
    task_.right = way == 1 || way == 3 ? reversed : power;
  }
  if (form >= 2) {
    task_.move_ms = move_ms;
    task_.drives = drives;
    task_.is_watching = false;
    return false;
  }
  if (drives) robot_motors(task_.left, task_.right);
  wait(move_ms, drives ? Wait::kMove : Wait::kPause);
  return true;
}

// Goes on where a comparison is TRUE, and else to its target. 80 + 10 for each source + 8 for the
// wide constant + the comparator. Returns how far it is to the next instruction, or 0 where this
// one cannot run.
tini_noinline uint16_t Machine::compare_and_branch(const uint8_t* bytes) {
  const uint8_t code = *bytes++;
  const uint8_t number = *bytes++;
  const int32_t* places = task_.variables;
  if (code >= 0x90) {
    places = readings_;
    if (!sense(number, code >= 0xa0)) return 0;
  }
  if (number >= kVariables || code >= kFamiliesEnd || code % 8 >= kFamilyOps) {
    fail();
    return 0;
  }
  int16_t constant = *bytes++;
  uint16_t distance = 4;
  if ((code & 8) != 0) {
    constant = static_cast<int16_t>(constant | *bytes++ << 8);
    distance++;
  }
  if (compare(places + number, constant, code)) return distance;
  return static_cast<uint16_t>(distance + *bytes);
}

// Goes on so many bytes behind, or before, the end of the instruction.
bool Machine::jump(Running* run, uint16_t distance) {
  run->next = static_cast<uint16_t>(run->next + distance);
  return true;
}

bool Machine::jump_back(Running* run, uint16_t distance) {
  run->next = static_cast<uint16_t>(run->next - distance);
  return true;
}

bool Machine::goes_on(Fault fault) {
  fault_ = fault;
  return fault == Fault::kNone;
}

// A check has failed that verified code never fails.
bool Machine::fail() { return goes_on(Fault::kBadCode); }

// Ends the tick before this instruction: the next one begins with it.
bool Machine::stay(Running* run) {
  run->next = run->at;
  return false;
}

// Runs one instruction. Returns whether the next one may run now.
//
// An instruction is decoded in one place: when its `case` begins, its operands are read, and the
// values that it takes lie at `values`. It ends with `break` where it leaves `value` there, else
// with `return`.
__attribute__((always_inline)) inline bool Machine::step(Running* run) {
  const uint16_t at = run->next;
  run->at = at;
  if (at > length_) return fail();
  const uint8_t* const bytes = code_ + at;
  const uint8_t code = *bytes;
  if (code >= kFamilies) {
    const uint16_t distance = compare_and_branch(bytes);
    run->next = static_cast<uint16_t>(at + distance);
    return distance != 0;
  }
  const uint8_t entry = flash_byte(kFormOf + code);
  uint8_t form = entry & kFormMask;
  uint8_t size = 1;
  uint16_t operand = 0;  // the first one or two bytes
  if (form >= kTwoBytes) {
    operand = bytes[1];
    size++;
    if (form >= kThreeBytes) {
      operand |= static_cast<uint16_t>(bytes[2] << 8);
      size++;
      if (form >= kFarForms) form = static_cast<uint8_t>(form - (kFarForms - kNearForms));
    }
  }
  run->next = static_cast<uint16_t>(at + size);
  if (entry > kFormMask) {
    run->depth = static_cast<uint8_t>(run->depth - (entry >> 6));
    if (static_cast<int8_t>(run->depth) < 0) return fail();
  }
  int32_t* const values = task_.stack + run->depth;
  int32_t value = *values;
  const uint8_t first = low(operand);
  const Op op = static_cast<Op>(code);
  switch (static_cast<Form>(form)) {
    case Form::kNone:
      return fail();

    // values
    case Form::kPush8:
      value = thousandths(signed8(first));
      break;
    case Form::kPush16:
      value = static_cast<int16_t>(operand);
      if (op == Op::kPush16) value = thousandths(static_cast<int16_t>(operand));
      break;
    case Form::kPush32:
      __builtin_memcpy(&value, bytes + 1, sizeof value);
      run->next = static_cast<uint16_t>(run->next + 2);
      break;
    case Form::kPushFalse:
      value = op == Op::kPushTrue ? 1 : 0;
      if (op != Op::kTime) break;
      value = static_cast<int32_t>(now_ms_ - task_.started_ms);
      if (value >= 0) break;
      return goes_on(Fault::kOverflow);
    case Form::kPushVar:
      if (first >= kVariables) return fail();
      value = task_.variables[first];
      break;
    case Form::kPushSensor:
    case Form::kRead:
      if (!sense(first, op != Op::kPushSensor)) return stay(run);
      if (op == Op::kRead) return true;
      value = readings_[first];
      break;
    case Form::kRandom:
      run->depth++;
      task_.random = next_random(task_.random);
      return goes_on(random_between(values, task_.random));
    case Form::kAdd:
    case Form::kNeg:
    case Form::kEq:
    case Form::kNot:
      run->depth++;
      return goes_on(calculate(op, values));
    case Form::kAndThen:
      if ((value != 0) == (op < Op::kOrElse)) return true;
      run->depth++;
      return jump(run, operand);

    // variables
    case Form::kSetVar:
      if (first >= kVariables) return fail();
      task_.variables[first] = value;
      return true;
    case Form::kSetVar8:
      if (first >= kVariables) return fail();
      *values = thousandths(signed8(high(operand)));
      if (op == Op::kSetVar8) {
        task_.variables[first] = *values;
        return true;
      }
      return goes_on(add(task_.variables + first, values));
    case Form::kAddVar: {
      const uint8_t second = high(operand);
      if ((first | second) >= kVariables) return fail();
      return goes_on(add(task_.variables + first, task_.variables + second));
    }

    // the robot
    case Form::kShow:
      if (robot_show(value, op == Op::kShowYesNo)) return true;
      run->depth++;
      return stay(run);
    case Form::kSet:
      robot_set(first, value);
      return true;
    case Form::kMoveF:
    case Form::kMove8F:
    case Form::kWatchF:
    case Form::kWatchForeverF:
    case Form::kWait:
    case Form::kWait8:
    case Form::kWatchWait:
    case Form::kWatchForeverWait:
      return !move(code, operand, values);
    case Form::kMotors:
      if (op == Op::kMotors) {
        robot_motors(percent(value, -100), percent(values[1], -100));
        return true;
      }
      robot_beep(static_cast<uint16_t>(limited(whole(values[1]), 31, 20000)), duration(value));
      wait(duration(value), Wait::kPause);
      return false;
    case Form::kUntil:
      if (value != 0) {
        finish();
        return true;
      }
      if (watch()) run->next = static_cast<uint16_t>(run->next - operand);
      return false;
    case Form::kStop:
      robot_motors(0, 0);
      return true;
    case Form::kMotors8:
      robot_motors(signed8(first), signed8(high(operand)));
      return true;

    // control
    case Form::kIf:
      if ((value != 0) == (op < Op::kIfNot)) return true;
      return jump(run, operand);
    case Form::kBreakLoop:
      if (task_.looped == 0) return fail();
      task_.looped--;
      return jump(run, operand);
    case Form::kElse:
    case Form::kBreak:
    case Form::kDef:
      return jump(run, operand);
    case Form::kForever:
    case Form::kWhile:
      return true;
    case Form::kLoop8:
    case Form::kLoop:
      value = op == Op::kLoop8 ? first : whole(value);
      if (value < 1) return jump(run, operand);
      if (task_.looped >= kCounters) return fail();
      task_.counters[task_.looped++] = value;
      return true;
    case Form::kNext:
      if (task_.looped == 0) return fail();
      if (--task_.counters[task_.looped - 1] != 0) return jump_back(run, operand);
      task_.looped--;
      return true;
    case Form::kCall:
      if (task_.called >= kCalls) return fail();
      task_.calls[task_.called++] = run->next;
      return jump_back(run, operand);
    case Form::kAgain:
      return jump_back(run, operand);
    case Form::kReturn:
      if (task_.called == 0) return fail();
      run->next = task_.calls[--task_.called];
      return true;
    case Form::kEnd:
      robot_off();
      status_ = Status::kDone;
      return stay(run);
  }
  *values = value;
  run->depth++;
  return run->depth <= kStackValues || fail();
}

// Runs instructions until the program must wait or ends, or the budget is used up.
tini_noinline void Machine::execute(uint8_t budget) {
  Machine* self = this;
  Running run = {task_.pc, task_.pc, task_.depth};
  bool goes_on = true;
  while (goes_on && budget != 0) {
    budget--;
    self = near(self);
    goes_on = self->step(&run);
  }
  self->at_ = run.at;
  self->left_ = budget;
  self->task_.pc = run.next;
  self->task_.depth = run.depth;
}

}  // namespace tiniscript
