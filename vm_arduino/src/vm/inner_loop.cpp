// Implements each instruction: a `case` for each opcode, in the order of the spec. `execute_avr.S` is
// the same for the AVR.
//
// The switch has no `default`, so the compiler reports a missing opcode.

#include "build.h"

#ifndef tiniscript_in_assembly

#include "arithmetic.h"
#include "inner_loop.h"
#include "machine.h"
#include "number.h"
#include "small.h"

// The eight instructions of one byte that have their operand in their code.
#define tini_each_short(op) \
  case Op::op##0:           \
  case Op::op##1:           \
  case Op::op##2:           \
  case Op::op##3:           \
  case Op::op##4:           \
  case Op::op##5:           \
  case Op::op##6:           \
  case Op::op##7

// The six instructions of a family that compares.
#define tini_each_comparator(op) \
  case Op::op##Eq:               \
  case Op::op##Ne:               \
  case Op::op##Lt:               \
  case Op::op##Le:               \
  case Op::op##Gt:               \
  case Op::op##Ge

namespace tiniscript {

namespace {

// The operand that is in the code of an instruction of one byte.
tini_always_inline uint8_t short_operand(uint8_t code) {
  return static_cast<uint8_t>(code % kShorts);
}

// The number that an instruction of one byte pushes: 0 to 10, and tens from 20 on.
tini_always_inline uint8_t pushed_number(uint8_t code) {
  const uint8_t n = static_cast<uint8_t>(code - static_cast<uint8_t>(Op::kPushNum0));
  return n <= 10 ? n : static_cast<uint8_t>((n - 9) * 10);
}

}  // namespace

// Runs one instruction. Returns whether the next one may run now.
//
// Operands are read one after the other: when a `case` returns, `next_` is after the last one.
tini_always_inline bool InnerLoop::step() {
  if (kCountsInstructions) budget_left_--;
  const uint8_t* const bytes = next_;
  start_ = bytes;
  if (static_cast<uint32_t>(bytes - machine_.code_) > machine_.length_) return fail(Fault::kBadCode);
  const uint8_t code = *bytes;
  const Op op = static_cast<Op>(code);
  next_++;
  switch (op) {
    // values
    case Op::kPush8:
      return push(to_thousandths(u8()));
    case Op::kPush16:
      return push(to_thousandths(i16()));
    case Op::kPushMilli:
      return push(i16());
    case Op::kPush32: {
      int32_t value;
      __builtin_memcpy(&value, next_, sizeof value);
      next_ += sizeof value;
      return push(value);
    }
    case Op::kPushFalse:
      return push(0);
    case Op::kPushTrue:
      return push(1);
    case Op::kPushVar:
      return push_variable(u8());
    case Op::kPushSensor:
      return push_sensor(u8());
    case Op::kPushRead:
      return push_read(u8());
    case Op::kTime:
      return push(0) && act(code);
    case Op::kRandom:
      if (!act(code)) return false;
      top_++;
      return true;
    case Op::kPushTenths:
      return push(i8() * 100);

    // calculating
    case Op::kAdd:
      return pop(2) && leave(sum(top_[0], top_[1], top_));
    case Op::kSub:
      return pop(2) && leave(difference(top_[0], top_[1], top_));
    case Op::kMul:
      return pop(2) && leave(calculate(Op::kMul, top_));
    case Op::kDiv:
      return pop(2) && leave(calculate(Op::kDiv, top_));
    case Op::kMod:
      return pop(2) && leave(calculate(Op::kMod, top_));
    case Op::kNeg:
    case Op::kAbs:
    case Op::kNot:
      return pop(1) && leave(calculate(op, top_));
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
      return pop(2) && leave(calculate(op, top_));
    case Op::kAndThen:
      return join(false, u8());
    case Op::kAndThenFar:
      return join(false, u16());
    case Op::kOrElse:
      return join(true, u8());
    case Op::kOrElseFar:
      return join(true, u16());

    // variables
    case Op::kSetVar:
      return set_variable(u8());
    case Op::kSetVar8: {
      const uint8_t number = u8();
      if (number >= kVariables) return fail(Fault::kBadCode);
      machine_.task_.variables[number] = to_thousandths(i8());
      return true;
    }
    case Op::kAddVar8: {
      const uint8_t number = u8();
      return add_to(number, to_thousandths(i8()));
    }
    case Op::kAddVar: {
      const uint8_t number = u8();
      const uint8_t second = u8();
      return second < kVariables ? add_to(number, machine_.task_.variables[second]) : fail(Fault::kBadCode);
    }
    case Op::kIncVar:
      return add_to(u8(), kOne);
    case Op::kDecVar:
      return add_to(u8(), -kOne);

    // the robot
    case Op::kRead:
      return read(u8());
    case Op::kShow:
    case Op::kShowYesNo:
      if (act(code)) return true;
      if (next_ == start_) top_++;
      return false;
    case Op::kEnd:
    case Op::kLook:
    case Op::kEndTask:
    case Op::kEndWhen:
      tini_each_act : return act(code);
    case Op::kEscape:
      return act(code, 2, 2);  // GO or WATCH_GO
    case Op::kUntil:
      return pop(1) && until(*top_ != 0);

    // control
    case Op::kIf:
      return pop(1) && jump_unless(*top_ != 0, u8());
    case Op::kIfFar:
      return pop(1) && jump_unless(*top_ != 0, u16());
    case Op::kIfNot:
      return pop(1) && jump_unless(*top_ == 0, u8());
    case Op::kIfNotFar:
      return pop(1) && jump_unless(*top_ == 0, u16());
    case Op::kElse:
    case Op::kBreak:
    case Op::kDef:
      return jump(u8());
    case Op::kElseFar:
    case Op::kBreakFar:
    case Op::kDefFar:
    case Op::kTask:
    case Op::kWhen:
      return jump(u16());
    case Op::kForever:
      return true;
    case Op::kWhile:
      next_++;
      return true;
    case Op::kWhileFar:
      next_ += 2;
      return true;
    case Op::kAgain:
      return repeat_loop(u8());
    case Op::kAgainFar:
      return repeat_loop(u16());
    case Op::kLoop8:
      return open(u8());
    case Op::kLoop:
      return loop(u8());
    case Op::kLoopFar:
      return loop(u16());
    case Op::kNext:
      return next_round(u8());
    case Op::kNextFar:
      return next_round(u16());
    case Op::kBreakLoop:
      return break_loop(u8());
    case Op::kBreakLoopFar:
      return break_loop(u16());
    case Op::kReturn:
      if (machine_.task_.frame_count == 0) return fail(Fault::kBadCode);
      next_ = machine_.code_ + machine_.task_.frames[--machine_.task_.frame_count];
      return true;
    case Op::kCall:
      return call(u8());
    case Op::kCallFar:
      return call(u16());

      // in one byte
      tini_each_short(kPushVar) : return push_variable(short_operand(code));
      tini_each_short(kPushSensor) : return push_sensor(short_operand(code));
      tini_each_short(kPushRead) : return push_read(short_operand(code));
      tini_each_short(kRead) : return read(short_operand(code));
      tini_each_short(kSetVar) : return set_variable(short_operand(code));
    tini_each_short(kPushNum) : case Op::kPushNum8:
    case Op::kPushNum9:
    case Op::kPushNum10:
    case Op::kPushNum20:
    case Op::kPushNum30:
    case Op::kPushNum40:
    case Op::kPushNum50:
    case Op::kPushNum60:
    case Op::kPushNum70:
    case Op::kPushNum80:
    case Op::kPushNum90:
    case Op::kPushNum100:
      return push(to_thousandths(pushed_number(code)));

      // with a constant
      tini_each_comparator(kUntil8) : return until_relates(op, to_thousandths(u8()));
      tini_each_comparator(kUntil16) : return until_relates(op, to_thousandths(i16()));
      tini_each_comparator(kIf8) : return jump_unless_relates(op, to_thousandths(u8()));
      tini_each_comparator(kIf16) : return jump_unless_relates(op, to_thousandths(i16()));
      tini_each_comparator(kIfVar8) : {
        const uint8_t number = u8();
        return jump_unless_variable_relates(number, op, to_thousandths(u8()));
      }
      tini_each_comparator(kIfVar16) : {
        const uint8_t number = u8();
        return jump_unless_variable_relates(number, op, to_thousandths(i16()));
      }
  }
  return fail(Fault::kBadCode);
}

// A computer on which somebody follows a program instruction by instruction counts these. The budget is
// not 0.
bool Machine::execute(uint8_t budget) {
  InnerLoop loop(this, budget);
  bool goes_on;
  do {
    goes_on = loop.step();
  } while (goes_on && !loop.is_over());
  loop.end();
  return goes_on;
}

bool Machine::run_turn() { return execute(budget_left_); }

bool Machine::reach_instruction(uint32_t now_ms) {
  if (status_ >= Status::kDone) return false;
  return fault_ != Fault::kNone || (wake(now_ms) && finds_turn(false)) || fault_ != Fault::kNone;
}

}  // namespace tiniscript

#endif
