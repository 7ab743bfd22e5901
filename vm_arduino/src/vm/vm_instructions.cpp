// What each instruction does: a `case` for each row of the table in `bytecode.py`.
//
// The switch has no `default`, so the compiler names an instruction that is forgotten.

#include "../robot.h"
#include "number.h"
#include "vm.h"

namespace tiniscript {

namespace {

constexpr uint8_t kTenthMs = 100;

// Milliseconds: a time in thousandths of a second, not below 0.
uint32_t duration(int32_t time) { return time < 0 ? 0 : static_cast<uint32_t>(time); }

// A power in percent, from `low` to 100.
int8_t percent(int32_t power, int8_t low) {
  return static_cast<int8_t>(limited(whole(power), low, 100));
}

}  // namespace

uint8_t Machine::byte() {
  if (task_.pc > length_) {
    raise(Fault::kBadCode);
    return 0;
  }
  return code_[task_.pc++];
}

uint16_t Machine::word() {
  const uint8_t low = byte();
  return static_cast<uint16_t>(low | byte() << 8);
}

// A whole number of one byte with a sign, as thousandths.
int32_t Machine::whole8() { return static_cast<int32_t>(static_cast<int8_t>(byte())) * kOne; }

int32_t Machine::whole16() { return static_cast<int32_t>(static_cast<int16_t>(word())) * kOne; }

// Where a jump forward leads: its operand is the last of its instruction.
uint16_t Machine::forward(bool is_far) {
  const uint16_t distance = is_far ? word() : byte();
  return static_cast<uint16_t>(task_.pc + distance);
}

uint16_t Machine::back(bool is_far) {
  const uint16_t distance = is_far ? word() : byte();
  return static_cast<uint16_t>(task_.pc - distance);
}

void Machine::push(int32_t value) {
  if (task_.depth >= kStackValues) return raise(Fault::kBadCode);
  task_.stack[task_.depth++] = value;
}

int32_t* Machine::top() {
  if (task_.depth == 0) {
    raise(Fault::kBadCode);
    return task_.stack;
  }
  return task_.stack + task_.depth - 1;
}

int32_t Machine::pop() {
  const int32_t value = *top();
  if (task_.depth != 0) task_.depth--;
  return value;
}

int32_t* Machine::variable() {
  const uint8_t number = byte();
  if (number >= kVariables) {
    raise(Fault::kBadCode);
    return task_.variables;
  }
  return task_.variables + number;
}

// The kept reading of a sensor; takes a reading first where it `must_read`. Null where the robot
// is not ready.
int32_t* Machine::sensor(bool must_read) {
  const uint8_t number = byte();
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

void Machine::show(bool is_yes_no) {
  if (!robot_show(*top(), is_yes_no)) return retry();
  pop();
}

void Machine::prepare(uint32_t move_ms, bool drives) {
  task_.move_ms = move_ms;
  task_.drives = drives;
  task_.is_watching = false;
}

// Notes the powers of a move. The last two bits of an opcode say which way: F, B, L, R.
void Machine::steer(uint8_t op, int8_t power) {
  const int8_t reversed = static_cast<int8_t>(-power);
  const uint8_t way = op & 3;
  task_.left = way == 1 || way == 2 ? reversed : power;
  task_.right = way == 1 || way == 3 ? reversed : power;
}

void Machine::open_counter(int32_t count) {
  if (task_.looped >= kCounters) return raise(Fault::kBadCode);
  task_.counters[task_.looped++] = count;
}

// The counter of the innermost counted loop.
int32_t* Machine::counter() {
  if (task_.looped == 0) {
    raise(Fault::kBadCode);
    task_.looped = 1;
  }
  return task_.counters + task_.looped - 1;
}

// Goes on where a comparison is TRUE, and else to its target. 80 + 10 for each source + 8 for
// the wide constant + the comparator.
void Machine::compare_and_branch(uint8_t op) {
  const int32_t* const value = op < 0x90 ? variable() : sensor(op >= 0xa0);
  if (value == nullptr) return;
  const int32_t number = (op & 8) != 0 ? whole16() : static_cast<int32_t>(byte()) * kOne;
  const uint16_t to = forward(false);
  if (!compare(*value, number, op)) task_.pc = to;
}

__attribute__((always_inline)) inline void Machine::step() {
  const uint8_t code = byte();
  const Op op = static_cast<Op>(code);
  int32_t right;
  int32_t* left;
  uint16_t to;
  switch (op) {
    // values
    case Op::kPush8:
      return push(whole8());
    case Op::kPush16:
      return push(whole16());
    case Op::kPushMilli:
      return push(static_cast<int16_t>(word()));
    case Op::kPush32: {
      const uint16_t low = word();
      return push(static_cast<int32_t>(low | static_cast<uint32_t>(word()) << 16));
    }
    case Op::kPushFalse:
      return push(0);
    case Op::kPushTrue:
      return push(1);
    case Op::kPushVar:
      return push(*variable());
    case Op::kPushSensor:
    case Op::kPushRead:
      left = sensor(op == Op::kPushRead);
      if (left != nullptr) push(*left);
      return;
    case Op::kTime: {
      const uint32_t gone_ms = now_ms_ - task_.started_ms;
      if (gone_ms > 0x7fffffff) return raise(Fault::kOverflow);
      return push(static_cast<int32_t>(gone_ms));
    }
    case Op::kRandom:
      right = pop();
      left = top();
      task_.random = next_random(task_.random);
      return raise(random_between(*left, right, task_.random, left));
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
      pop();  // it still lies behind the other one
      return raise(calculate(op, top()));
    case Op::kNeg:
    case Op::kAbs:
    case Op::kNot:
      return raise(calculate(op, top()));
    case Op::kAndThen:
    case Op::kAndThenFar:
      to = forward(op == Op::kAndThenFar);
      if (*top() == 0) {
        task_.pc = to;
      } else {
        pop();
      }
      return;
    case Op::kOrElse:
    case Op::kOrElseFar:
      to = forward(op == Op::kOrElseFar);
      if (*top() != 0) {
        task_.pc = to;
      } else {
        pop();
      }
      return;

    // variables
    case Op::kSetVar:
      left = variable();
      *left = pop();
      return;
    case Op::kSetVar8:
      left = variable();
      *left = whole8();
      return;
    case Op::kAddVar8:
      left = variable();
      return raise(sum(*left, whole8(), false, left));
    case Op::kAddVar:
      left = variable();
      return raise(sum(*left, *variable(), false, left));

    // the robot
    case Op::kRead:
      sensor(true);
      return;
    case Op::kShow:
      return show(false);
    case Op::kShowYesNo:
      return show(true);
    case Op::kSet: {
      const uint8_t actuator = byte();
      return robot_set(actuator, pop());
    }
    case Op::kMoveF:
    case Op::kMoveB:
    case Op::kMoveL:
    case Op::kMoveR:
      steer(code, percent(pop(), 0));
      robot_motors(task_.left, task_.right);
      return wait(duration(pop()), Wait::kMove);
    case Op::kMove8F:
    case Op::kMove8B:
    case Op::kMove8L:
    case Op::kMove8R: {
      const uint16_t move_ms = static_cast<uint16_t>(byte() * kTenthMs);
      steer(code, static_cast<int8_t>(byte()));
      robot_motors(task_.left, task_.right);
      return wait(move_ms, Wait::kMove);
    }
    case Op::kWatchF:
    case Op::kWatchB:
    case Op::kWatchL:
    case Op::kWatchR:
      steer(code, percent(pop(), 0));
      return prepare(duration(pop()), true);
    case Op::kWatchForeverF:
    case Op::kWatchForeverB:
    case Op::kWatchForeverL:
    case Op::kWatchForeverR:
      steer(code, percent(pop(), 0));
      return prepare(kForever, true);
    case Op::kWait:
      return wait(duration(pop()), Wait::kPause);
    case Op::kWait8:
      return wait(static_cast<uint16_t>(byte() * kTenthMs), Wait::kPause);
    case Op::kWatchWait:
      return prepare(duration(pop()), false);
    case Op::kWatchForeverWait:
      return prepare(kForever, false);
    case Op::kUntil:
    case Op::kUntilFar:
      to = back(op == Op::kUntilFar);
      return until(pop() != 0, to);
    case Op::kStop:
      return robot_motors(0, 0);
    case Op::kMotors: {
      const int8_t power = percent(pop(), -100);
      return robot_motors(percent(pop(), -100), power);
    }
    case Op::kMotors8: {
      const int8_t power = static_cast<int8_t>(byte());
      return robot_motors(power, static_cast<int8_t>(byte()));
    }
    case Op::kBeep: {
      const uint16_t hertz = static_cast<uint16_t>(limited(whole(pop()), 31, 20000));
      const uint32_t sound_ms = duration(pop());
      robot_beep(hertz, sound_ms);
      return wait(sound_ms, Wait::kPause);
    }

    // control
    case Op::kIf:
    case Op::kIfFar:
      to = forward(op == Op::kIfFar);
      if (pop() == 0) task_.pc = to;
      return;
    case Op::kIfNot:
    case Op::kIfNotFar:
      to = forward(op == Op::kIfNotFar);
      if (pop() != 0) task_.pc = to;
      return;
    case Op::kElse:
    case Op::kBreak:
    case Op::kDef:
      task_.pc = forward(false);
      return;
    case Op::kElseFar:
    case Op::kBreakFar:
    case Op::kDefFar:
      task_.pc = forward(true);
      return;
    case Op::kForever:
      return;
    case Op::kWhile:
    case Op::kWhileFar:
      forward(op == Op::kWhileFar);
      return;
    case Op::kAgain:
    case Op::kAgainFar:
      task_.pc = back(op == Op::kAgainFar);
      return;
    case Op::kLoop8:
      return open_counter(byte());
    case Op::kLoop:
    case Op::kLoopFar: {
      to = forward(op == Op::kLoopFar);
      const int32_t count = whole(pop());
      if (count >= 1) return open_counter(count);
      task_.pc = to;
      return;
    }
    case Op::kNext:
    case Op::kNextFar:
      to = back(op == Op::kNextFar);
      if (--*counter() != 0) {
        task_.pc = to;
      } else {
        task_.looped--;
      }
      return;
    case Op::kBreakLoop:
    case Op::kBreakLoopFar:
      task_.pc = forward(op == Op::kBreakLoopFar);
      counter();
      task_.looped--;
      return;
    case Op::kCall:
    case Op::kCallFar:
      to = back(op == Op::kCallFar);
      if (task_.called >= kCalls) return raise(Fault::kBadCode);
      task_.calls[task_.called++] = task_.pc;
      task_.pc = to;
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

    // compare and branch
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
      return compare_and_branch(code);
  }
  raise(Fault::kBadCode);
}

// Runs instructions until one must wait, or the budget is used up.
void Machine::execute() {
  while (left_ != 0 && !must_stop_) {
    left_--;
    at_ = task_.pc;
    step();
  }
}

}  // namespace tiniscript
