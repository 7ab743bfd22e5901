// For all chips but the AVR, which has `execute_avr.S`.

#ifndef __AVR__

// Implements each instruction: one `case` per family in `bytecode.h`.
//
// The switch has no `default`, so the compiler reports a missing family.

#include "number.h"
#include "shape.h"
#include "small.h"
#include "vm.h"

namespace tiniscript {

namespace {

// The second byte of a word of operands, and a number with a sign.
uint8_t high(uint16_t operand) { return static_cast<uint8_t>(operand >> 8); }
int8_t signed8(uint8_t operand) { return static_cast<int8_t>(operand); }

// The number that a one-byte instruction pushes: 0 to 10, and tens from 20 on.
uint8_t pushed(uint8_t code) {
  const uint8_t n = static_cast<uint8_t>(code - static_cast<uint8_t>(Op::kPushNum0));
  return n <= 10 ? n : static_cast<uint8_t>((n - 9) * 10);
}

}  // namespace

// Jumps by this many bytes forward or back from the end of the instruction.
bool Machine::jump(Running* run, uint16_t distance) {
  run->next = static_cast<uint16_t>(run->next + distance);
  return true;
}

bool Machine::jump_back(Running* run, uint16_t distance) {
  run->next = static_cast<uint16_t>(run->next - distance);
  return true;
}

// Ends the tick before this instruction; the next tick begins with it.
bool Machine::stay(Running* run) {
  run->next = run->at;
  return false;
}

// Lets `act` and `until` see where the program is, and go elsewhere.
bool Machine::act(Running* run, uint8_t code, const uint8_t* bytes, int32_t* top) {
  at_ = run->at;
  task_.pc = run->next;
  const bool goes_on = act(code, bytes, top);
  run->next = task_.pc;
  return goes_on;
}

bool Machine::until(Running* run, bool stop) {
  task_.pc = run->next;
  const bool goes_on = until(stop);
  run->next = task_.pc;
  return goes_on;
}

// Runs one instruction. Returns whether the next one may run now.
//
// Decoding is in one place: when a `case` begins, the operands are read and the values that it
// takes lie at `values`. It ends with `break` if it leaves `value` there, else with `return`.
__attribute__((always_inline)) inline bool Machine::step(Running* run) {
  const uint16_t at = run->next;
  run->at = at;
  if (at > length_) return fail();
  const uint8_t* const bytes = code_ + at;
  const uint8_t code = *bytes;
  const Shape shape = shape_of(code);
  const uint8_t size = shape.size();
  run->next = static_cast<uint16_t>(at + size);
  if (run->depth < shape.pops()) return fail();
  run->depth = static_cast<uint8_t>(run->depth - shape.pops());
  int32_t* const values = task_.stack + run->depth;
  int32_t value = *values;
  // the first byte of operands, which the code of an instruction of one byte says; the first two;
  // and the last one or two
  const uint8_t first = static_cast<uint8_t>(size == 1 ? code % kShorts : bytes[1]);
  const uint16_t operand = static_cast<uint16_t>(bytes[1] | bytes[2] << 8);
  const uint16_t distance = shape.is_far() ? operand : bytes[size - 1];
  const Op op = static_cast<Op>(code);
  switch (shape.family) {
    case Family::kNone:
      return fail();

    // values
    case Family::kPushNum:
      value = thousandths(pushed(code));
      break;
    case Family::kPush8:
      value = thousandths(first);
      break;
    case Family::kPush16:
      value = thousandths(static_cast<int16_t>(operand));
      break;
    case Family::kPushTenths:
      value = static_cast<int16_t>(signed8(first) * 100);
      break;
    case Family::kPushMilli:
      value = static_cast<int16_t>(operand);
      break;
    case Family::kPush32:
      __builtin_memcpy(&value, bytes + 1, sizeof value);
      break;
    case Family::kPushFalse:
      value = 0;
      break;
    case Family::kPushTrue:
      value = 1;
      break;
    case Family::kPushVar:
      if (first >= kVariables) return fail();
      value = task_.variables[first];
      break;
    case Family::kPushSensor:
      if (first >= sensors_) return fail();
      value = readings_[first];
      break;
    case Family::kPushRead:
      if (!sense(first)) return stay(run);
      value = readings_[first];
      break;
    case Family::kTime:
      run->depth++;
      return act(run, code, bytes, values) && (run->depth <= kStackValues || fail());
    case Family::kRandom:
      run->depth++;
      return act(run, code, bytes, values + 1);
    case Family::kCalculate:
      run->depth++;
      return goes_on(calculate(op, values));
    case Family::kAndThen:
      if (value != 0) return true;
      run->depth++;
      return jump(run, distance);
    case Family::kOrElse:
      if (value == 0) return true;
      run->depth++;
      return jump(run, distance);

    // variables
    case Family::kSetVar:
      if (first >= kVariables) return fail();
      task_.variables[first] = value;
      return true;
    case Family::kSetVar8:
      if (first >= kVariables) return fail();
      task_.variables[first] = thousandths(signed8(high(operand)));
      return true;
    case Family::kAddVar8:
      if (first >= kVariables) return fail();
      *values = thousandths(signed8(high(operand)));
      return goes_on(add(task_.variables + first, values));
    case Family::kAddVar: {
      const uint8_t second = high(operand);
      if ((first | second) >= kVariables) return fail();
      return goes_on(add(task_.variables + first, task_.variables + second));
    }
    case Family::kIncVar:
      if (first >= kVariables) return fail();
      *values = kOne;
      return goes_on(add(task_.variables + first, values));
    case Family::kDecVar:
      if (first >= kVariables) return fail();
      *values = -kOne;
      return goes_on(add(task_.variables + first, values));

    // the robot
    case Family::kRead:
      return sense(first) || stay(run);
    case Family::kShow:
    case Family::kShowYesNo:
      if (act(run, code, bytes, values)) return true;
      run->depth++;
      return false;
    case Family::kSet:
    case Family::kStop:
    case Family::kMotors:
    case Family::kMotors8:
    case Family::kMove:
    case Family::kMove8:
    case Family::kWatch:
    case Family::kWatchForever:
    case Family::kWait:
    case Family::kWait8:
    case Family::kWatchWait:
    case Family::kWatchForeverWait:
    case Family::kBeep:
    case Family::kBeep8:
    case Family::kEnd:
      return act(run, code, bytes, values + shape.pops() - 1);
    case Family::kUntil:
      return until(run, value != 0);
    case Family::kUntil8:
      return until(run, compare(values, first, code));
    case Family::kUntil16:
      return until(run, compare(values, static_cast<int16_t>(operand), code));

    // control
    case Family::kIf:
      return value != 0 || jump(run, distance);
    case Family::kIfNot:
      return value == 0 || jump(run, distance);
    case Family::kIf8:
      return compare(values, first, code) || jump(run, distance);
    case Family::kIf16:
      return compare(values, static_cast<int16_t>(operand), code) || jump(run, distance);
    case Family::kIfVar8:
      if (first >= kVariables) return fail();
      return compare(task_.variables + first, high(operand), code) || jump(run, distance);
    case Family::kIfVar16: {
      if (first >= kVariables) return fail();
      const int16_t constant = static_cast<int16_t>(high(operand) | bytes[3] << 8);
      return compare(task_.variables + first, constant, code) || jump(run, distance);
    }
    case Family::kElse:
    case Family::kBreak:
    case Family::kDef:
      return jump(run, distance);
    case Family::kForever:
    case Family::kWhile:
      return true;
    case Family::kAgain:
      return jump_back(run, distance);
    case Family::kLoop8:
    case Family::kLoop:
      value = op == Op::kLoop8 ? first : whole(value);
      if (value < 1) return jump(run, distance);
      if (task_.looped >= kCounters) return fail();
      task_.counters[task_.looped++] = value;
      return true;
    case Family::kNext:
      if (task_.looped == 0) return fail();
      if (--task_.counters[task_.looped - 1] != 0) return jump_back(run, distance);
      task_.looped--;
      return true;
    case Family::kBreakLoop:
      if (task_.looped == 0) return fail();
      task_.looped--;
      return jump(run, distance);
    case Family::kCall:
      if (task_.called >= kCalls) return fail();
      task_.calls[task_.called++] = run->next;
      return jump_back(run, distance);
    case Family::kReturn:
      if (task_.called == 0) return fail();
      run->next = task_.calls[--task_.called];
      return true;
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

#endif
