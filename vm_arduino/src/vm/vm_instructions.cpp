// What each instruction does: a `case` for each row of the table in `bytecode.py`.
//
// The switch has no `default`, so the compiler names an instruction that is forgotten.

#include "../robot.h"
#include "number.h"
#include "shape.h"
#include "vm.h"

namespace tiniscript {

namespace {

// The two operands of one byte that a word of operands is, and a number with a sign.
uint8_t low(uint16_t operand) { return static_cast<uint8_t>(operand & 0xff); }
uint8_t high(uint16_t operand) { return static_cast<uint8_t>(operand >> 8); }
int8_t signed8(uint8_t operand) { return static_cast<int8_t>(operand); }

uint16_t word(const uint8_t* bytes) { return static_cast<uint16_t>(bytes[0] | bytes[1] << 8); }

// A whole number, as thousandths.
int32_t thousandths(int16_t whole) { return int32_t{whole} * kOne; }

constexpr uint8_t kTenthMs = 100;

// Milliseconds: a time in thousandths of a second, not below 0.
uint32_t duration(int32_t time) { return time < 0 ? 0 : static_cast<uint32_t>(time); }

// A power in percent, from `low` to 100.
int8_t percent(int32_t power, int8_t low) {
  return static_cast<int8_t>(limited(whole(power), low, 100));
}

}  // namespace

int32_t* Machine::variable(uint8_t number) {
  if (number >= kVariables) {
    raise(Fault::kBadCode);
    number = 0;
  }
  return task_.variables + number;
}

// The kept reading of a sensor; takes a reading first where it `must_read`. Null where the robot
// is not ready.
int32_t* Machine::sensor(uint8_t number, bool must_read) {
  if (number >= sensors_) {
    raise(Fault::kBadCode);
    return nullptr;
  }
  int32_t* const reading = task_.readings + number;
  if (must_read && !robot_read(number, reading)) {
    retry();
    return nullptr;
  }
  return reading;
}

// MOVE to WATCH_FOREVER and WAIT to WATCH_FOREVER_WAIT. Each comes in four forms: with a time from
// the stack, with bytes, watched, and watched forever.
void Machine::move(uint8_t code, uint16_t operand, const int32_t* values) {
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
    return;
  }
  if (drives) robot_motors(task_.left, task_.right);
  wait(move_ms, drives ? Wait::kMove : Wait::kPause);
}

void Machine::open_counter(int32_t count) {
  if (task_.looped >= kCounters) return raise(Fault::kBadCode);
  task_.counters[task_.looped++] = count;
}

// Counts the innermost counted loop down, or drops it. Returns whether it goes on.
bool Machine::count(bool drops) {
  if (task_.looped == 0) {
    raise(Fault::kBadCode);
    return false;
  }
  int32_t* const counter = task_.counters + task_.looped - 1;
  if (!drops && --*counter != 0) return true;
  task_.looped--;
  return false;
}

// Goes on where a comparison is TRUE, and else to its target. 80 + 10 for each source + 8 for
// the wide constant + the comparator.
void Machine::compare_and_branch(uint8_t code, uint16_t operand) {
  const uint8_t number = low(operand);
  const int32_t* const value = code < 0x90 ? variable(number) : sensor(number, code >= 0xa0);
  if (value == nullptr) return;
  int16_t constant = high(operand);
  if ((code & 8) != 0) constant = static_cast<int16_t>(word(code_ + at_ + 2));
  if (!compare(*value, thousandths(constant), code)) {
    task_.pc = static_cast<uint16_t>(task_.pc + code_[task_.pc - 1]);
  }
}

// Goes behind the instruction and takes its values off the stack. Where they lay its result goes:
// `value` is the first of them, and what comes back to its place.
__attribute__((always_inline)) inline void Machine::step() {
  const uint16_t at = task_.pc;
  at_ = at;
  depth_ = task_.depth;
  if (at > length_) return raise(Fault::kBadCode);
  const uint8_t* const bytes = code_ + at;
  const uint8_t code = *bytes;
  const Shape shape = shape_of(code);
  if (shape.row == nullptr || depth_ < shape.pops()) return raise(Fault::kBadCode);
  const uint8_t size = shape.size();
  const uint16_t pc = static_cast<uint16_t>(at + size);
  task_.pc = pc;
  const uint8_t left = static_cast<uint8_t>(depth_ - shape.pops());
  task_.depth = static_cast<uint8_t>(left + shape.pushes());
  if (pc > length_ + 1 || task_.depth > kStackValues) return raise(Fault::kBadCode);
  uint16_t operand = 0;  // the first one or two bytes
  if (size > 1) operand = bytes[1];
  if (size > 2) operand |= static_cast<uint16_t>(bytes[2] << 8);
  // one room for them all, and half as large a table of the others
  if (code >= kFamilies) return compare_and_branch(code, operand);
  int32_t* const values = task_.stack + left;
  int32_t value = *values;
  const bool is_true = value != 0;
  const uint8_t first = low(operand);
  // where a jump leads
  const uint16_t to = static_cast<uint16_t>(pc + operand);
  const uint16_t back = static_cast<uint16_t>(pc - operand);
  const Op op = static_cast<Op>(code);
  int32_t* place;
  switch (op) {
    // values
    case Op::kPush8:
      value = thousandths(signed8(first));
      break;
    case Op::kPush16:
      value = thousandths(static_cast<int16_t>(operand));
      break;
    case Op::kPushMilli:
      value = static_cast<int16_t>(operand);
      break;
    case Op::kPush32:
      value = static_cast<int32_t>(operand | static_cast<uint32_t>(word(bytes + 3)) << 16);
      break;
    case Op::kPushFalse:
    case Op::kPushTrue:
      value = op == Op::kPushTrue ? 1 : 0;
      break;
    case Op::kPushVar:
      value = *variable(first);
      break;
    case Op::kPushSensor:
    case Op::kPushRead:
      place = sensor(first, op == Op::kPushRead);
      if (place != nullptr) value = *place;
      break;
    case Op::kTime:
      value = static_cast<int32_t>(now_ms_ - task_.started_ms);
      if (value < 0) raise(Fault::kOverflow);
      break;
    case Op::kRandom:
      task_.random = next_random(task_.random);
      return raise(random_between(value, values[1], task_.random, values));
    case Op::kAdd:
    case Op::kSub:
    case Op::kMul:
    case Op::kDiv:
    case Op::kMod:
    case Op::kMin:
    case Op::kMax:
    case Op::kRound:
    case Op::kEq:
    case Op::kNe:
    case Op::kLt:
    case Op::kLe:
    case Op::kGt:
    case Op::kGe:
    case Op::kAnd:
    case Op::kOr:
    case Op::kNeg:
    case Op::kAbs:
    case Op::kNot:
      return raise(calculate(op, values));
    case Op::kAndThen:
    case Op::kAndThenFar:
      if (is_true) return;
      task_.depth++;
      task_.pc = to;
      return;
    case Op::kOrElse:
    case Op::kOrElseFar:
      if (!is_true) return;
      task_.depth++;
      task_.pc = to;
      return;

    // variables
    case Op::kSetVar:
      *variable(first) = value;
      return;
    case Op::kSetVar8:
    case Op::kAddVar8:
    case Op::kAddVar: {
      place = variable(first);
      const uint8_t second = high(operand);
      const int32_t number = op == Op::kAddVar ? *variable(second) : thousandths(signed8(second));
      if (op != Op::kSetVar8) return raise(sum(*place, number, false, place));
      *place = number;
      return;
    }

    // the robot
    case Op::kRead:
      sensor(first, true);
      return;
    case Op::kShow:
    case Op::kShowYesNo:
      if (!robot_show(value, op == Op::kShowYesNo)) retry();
      return;
    case Op::kSet:
      return robot_set(first, value);
    case Op::kMoveF:
    case Op::kMoveB:
    case Op::kMoveL:
    case Op::kMoveR:
    case Op::kMove8F:
    case Op::kMove8B:
    case Op::kMove8L:
    case Op::kMove8R:
    case Op::kWatchF:
    case Op::kWatchB:
    case Op::kWatchL:
    case Op::kWatchR:
    case Op::kWatchForeverF:
    case Op::kWatchForeverB:
    case Op::kWatchForeverL:
    case Op::kWatchForeverR:
    case Op::kWait:
    case Op::kWait8:
    case Op::kWatchWait:
    case Op::kWatchForeverWait:
      return move(code, operand, values);
    case Op::kUntil:
    case Op::kUntilFar:
      return until(is_true, back);
    case Op::kStop:
      return robot_motors(0, 0);
    case Op::kMotors:
      return robot_motors(percent(value, -100), percent(values[1], -100));
    case Op::kMotors8:
      return robot_motors(signed8(first), signed8(high(operand)));
    case Op::kBeep: {
      const uint32_t sound_ms = duration(value);
      robot_beep(static_cast<uint16_t>(limited(whole(values[1]), 31, 20000)), sound_ms);
      return wait(sound_ms, Wait::kPause);
    }

    // control
    case Op::kIf:
    case Op::kIfFar:
      if (!is_true) task_.pc = to;
      return;
    case Op::kIfNot:
    case Op::kIfNotFar:
      if (is_true) task_.pc = to;
      return;
    case Op::kBreakLoop:
    case Op::kBreakLoopFar:
      count(true);
      task_.pc = to;
      return;
    case Op::kElse:
    case Op::kBreak:
    case Op::kDef:
    case Op::kElseFar:
    case Op::kBreakFar:
    case Op::kDefFar:
      task_.pc = to;
      return;
    case Op::kForever:
    case Op::kWhile:
    case Op::kWhileFar:
      return;
    case Op::kAgain:
    case Op::kAgainFar:
      task_.pc = back;
      return;
    case Op::kLoop8:
      return open_counter(first);
    case Op::kLoop:
    case Op::kLoopFar: {
      const int32_t times = whole(value);
      if (times >= 1) return open_counter(times);
      task_.pc = to;
      return;
    }
    case Op::kNext:
    case Op::kNextFar:
      if (count(false)) task_.pc = back;
      return;
    case Op::kCall:
    case Op::kCallFar:
      if (task_.called >= kCalls) return raise(Fault::kBadCode);
      task_.calls[task_.called++] = pc;
      task_.pc = back;
      return;
    case Op::kReturn:
      if (task_.called == 0) return raise(Fault::kBadCode);
      task_.pc = task_.calls[--task_.called];
      return;
    case Op::kEnd:
      robot_off();
      status_ = Status::kDone;
      must_stop_ = true;
      task_.pc = at_;
      return;

    // compare and branch: done above
    case Op::kIfVar8Eq:
    case Op::kIfVar8Ne:
    case Op::kIfVar8Lt:
    case Op::kIfVar8Le:
    case Op::kIfVar8Gt:
    case Op::kIfVar8Ge:
    case Op::kIfVar16Eq:
    case Op::kIfVar16Ne:
    case Op::kIfVar16Lt:
    case Op::kIfVar16Le:
    case Op::kIfVar16Gt:
    case Op::kIfVar16Ge:
    case Op::kIfSensor8Eq:
    case Op::kIfSensor8Ne:
    case Op::kIfSensor8Lt:
    case Op::kIfSensor8Le:
    case Op::kIfSensor8Gt:
    case Op::kIfSensor8Ge:
    case Op::kIfSensor16Eq:
    case Op::kIfSensor16Ne:
    case Op::kIfSensor16Lt:
    case Op::kIfSensor16Le:
    case Op::kIfSensor16Gt:
    case Op::kIfSensor16Ge:
    case Op::kIfRead8Eq:
    case Op::kIfRead8Ne:
    case Op::kIfRead8Lt:
    case Op::kIfRead8Le:
    case Op::kIfRead8Gt:
    case Op::kIfRead8Ge:
    case Op::kIfRead16Eq:
    case Op::kIfRead16Ne:
    case Op::kIfRead16Lt:
    case Op::kIfRead16Le:
    case Op::kIfRead16Gt:
    case Op::kIfRead16Ge:
      return;  // it is done
  }
  *values = value;
}

// Runs instructions until one must wait, or the budget is used up.
void Machine::execute() {
  while (left_ != 0 && !must_stop_) {
    left_--;
    step();
  }
}

}  // namespace tiniscript
