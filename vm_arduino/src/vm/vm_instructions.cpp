// For all chips but an AVR whose machine is in assembly: `execute_avr.S`.

#include "has_tasks.h"

#ifndef tiniscript_in_assembly

// Implements each instruction: a `case` for each opcode, in the order of the spec.
//
// The switch has no `default`, so the compiler reports a missing opcode. Where the program is stays
// in registers: nothing that is called gets the address of `Running`, as all that takes it is
// copied into the loop.

#include "arithmetic.h"
#include "number.h"
#include "small.h"
#include "steps.h"
#include "vm.h"

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
tini_always_inline uint8_t in_code(uint8_t code) { return static_cast<uint8_t>(code % kShorts); }

// The number that an instruction of one byte pushes: 0 to 10, and tens from 20 on.
tini_always_inline uint8_t pushed(uint8_t code) {
  const uint8_t n = static_cast<uint8_t>(code - static_cast<uint8_t>(Op::kPushNum0));
  return n <= 10 ? n : static_cast<uint8_t>((n - 9) * 10);
}

}  // namespace

// Runs one instruction. Returns whether the next one may run now.
//
// Operands are read one after the other: when a `case` returns, `run->next` is behind the last one.
tini_always_inline bool Machine::step(Running* run) {
  const uint8_t* const bytes = run->next;
  run->at = bytes;
  if (static_cast<uint32_t>(bytes - code_) > length_) return halt(Fault::kBadCode);
  const uint8_t code = *bytes;
  const Op op = static_cast<Op>(code);
  run->next++;
  switch (op) {
    // values
    case Op::kPush8:
      return push(run, in_thousandths(run->u8()));
    case Op::kPush16:
      return push(run, in_thousandths(run->i16()));
    case Op::kPushMilli:
      return push(run, run->i16());
    case Op::kPush32: {
      int32_t value;
      __builtin_memcpy(&value, run->next, sizeof value);
      run->next += sizeof value;
      return push(run, value);
    }
    case Op::kPushFalse:
      return push(run, 0);
    case Op::kPushTrue:
      return push(run, 1);
    case Op::kPushVar:
      return push_variable(run, run->u8());
    case Op::kPushSensor:
      return push_sensor(run, run->u8());
    case Op::kPushRead:
      return push_read(run, run->u8());
    case Op::kTime:
      return push(run, 0) && act(run, code);
    case Op::kRandom:
      if (!act(run, code)) return false;
      run->top++;
      return true;
    case Op::kPushTenths:
      return push(run, run->i8() * 100);

    // calculating
    case Op::kAdd:
      return pop(run, 2) && leave(run, sum(run->top[0], run->top[1], run->top));
    case Op::kSub:
      return pop(run, 2) && leave(run, difference(run->top[0], run->top[1], run->top));
    case Op::kMul:
      return pop(run, 2) && leave(run, calculate(Op::kMul, run->top));
    case Op::kDiv:
      return pop(run, 2) && leave(run, calculate(Op::kDiv, run->top));
    case Op::kMod:
      return pop(run, 2) && leave(run, calculate(Op::kMod, run->top));
    case Op::kNeg:
    case Op::kAbs:
    case Op::kNot:
      return pop(run, 1) && leave(run, calculate(op, run->top));
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
      return pop(run, 2) && leave(run, calculate(op, run->top));
    case Op::kAndThen:
      return join(run, false, run->u8());
    case Op::kAndThenFar:
      return join(run, false, run->u16());
    case Op::kOrElse:
      return join(run, true, run->u8());
    case Op::kOrElseFar:
      return join(run, true, run->u16());

    // variables
    case Op::kSetVar:
      return set_variable(run, run->u8());
    case Op::kSetVar8: {
      const uint8_t number = run->u8();
      if (number >= kVariables) return halt(Fault::kBadCode);
      task_.variables[number] = in_thousandths(run->i8());
      return true;
    }
    case Op::kAddVar8: {
      const uint8_t number = run->u8();
      return add_to(number, in_thousandths(run->i8()));
    }
    case Op::kAddVar: {
      const uint8_t number = run->u8();
      const uint8_t second = run->u8();
      return second < kVariables ? add_to(number, task_.variables[second]) : halt(Fault::kBadCode);
    }
    case Op::kIncVar:
      return add_to(run->u8(), kOne);
    case Op::kDecVar:
      return add_to(run->u8(), -kOne);

    // the robot
    case Op::kRead:
      return sense(run->u8()) || stay(run);
    case Op::kShow:
    case Op::kShowYesNo:
      if (act(run, code)) return true;
      if (run->next == run->at) run->top++;
      return false;
    case Op::kSet:
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
    case Op::kBeep8:
    case Op::kStop:
    case Op::kMotors:
    case Op::kMotors8:
    case Op::kBeep:
    case Op::kEnd:
    case Op::kLook:
    case Op::kEndTask:
    case Op::kEndWhen:
      tini_each_short(kSet) : return act(run, code);
    case Op::kEscape:
      return way(run);
    case Op::kUntil:
      return pop(run, 1) && until(run, *run->top != 0);

    // control
    case Op::kIf:
      return pop(run, 1) && unless(run, *run->top != 0, run->u8());
    case Op::kIfFar:
      return pop(run, 1) && unless(run, *run->top != 0, run->u16());
    case Op::kIfNot:
      return pop(run, 1) && unless(run, *run->top == 0, run->u8());
    case Op::kIfNotFar:
      return pop(run, 1) && unless(run, *run->top == 0, run->u16());
    case Op::kElse:
    case Op::kBreak:
    case Op::kDef:
      return jump(run, run->u8());
    case Op::kElseFar:
    case Op::kBreakFar:
    case Op::kDefFar:
    case Op::kTask:
    case Op::kWhen:
      return jump(run, run->u16());
    case Op::kForever:
      return true;
    case Op::kWhile:
      run->next++;
      return true;
    case Op::kWhileFar:
      run->next += 2;
      return true;
    case Op::kAgain:
      return again(run, run->u8());
    case Op::kAgainFar:
      return again(run, run->u16());
    case Op::kLoop8:
      return open(run->u8());
    case Op::kLoop:
      return loop(run, run->u8());
    case Op::kLoopFar:
      return loop(run, run->u16());
    case Op::kNext:
      return next(run, run->u8());
    case Op::kNextFar:
      return next(run, run->u16());
    case Op::kBreakLoop:
      return break_loop(run, run->u8());
    case Op::kBreakLoopFar:
      return break_loop(run, run->u16());
    case Op::kReturn:
      if (task_.framed == 0) return halt(Fault::kBadCode);
      run->next = code_ + task_.frames[--task_.framed];
      return true;
    case Op::kCall:
      return call(run, run->u8());
    case Op::kCallFar:
      return call(run, run->u16());

      // in one byte
      tini_each_short(kPushVar) : return push_variable(run, in_code(code));
      tini_each_short(kPushSensor) : return push_sensor(run, in_code(code));
      tini_each_short(kPushRead) : return push_read(run, in_code(code));
      tini_each_short(kRead) : return sense(in_code(code)) || stay(run);
      tini_each_short(kSetVar) : return set_variable(run, in_code(code));
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
      return push(run, in_thousandths(pushed(code)));

      // with a constant
      tini_each_comparator(kUntil8) : {
        const int32_t constant = in_thousandths(run->u8());
        return pop(run, 1) && until(run, relates(*run->top, comparator_of(op), constant));
      }
      tini_each_comparator(kUntil16) : {
        const int32_t constant = in_thousandths(run->i16());
        return pop(run, 1) && until(run, relates(*run->top, comparator_of(op), constant));
      }
      tini_each_comparator(kIf8) : {
        const int32_t constant = in_thousandths(run->u8());
        return pop(run, 1) &&
               unless(run, relates(*run->top, comparator_of(op), constant), run->u8());
      }
      tini_each_comparator(kIf16) : {
        const int32_t constant = in_thousandths(run->i16());
        return pop(run, 1) &&
               unless(run, relates(*run->top, comparator_of(op), constant), run->u8());
      }
      tini_each_comparator(kIfVar8) : {
        const uint8_t number = run->u8();
        if (number >= kVariables) return halt(Fault::kBadCode);
        const int32_t constant = in_thousandths(run->u8());
        return unless(run, relates(task_.variables[number], comparator_of(op), constant),
                      run->u8());
      }
      tini_each_comparator(kIfVar16) : {
        const uint8_t number = run->u8();
        if (number >= kVariables) return halt(Fault::kBadCode);
        const int32_t constant = in_thousandths(run->i16());
        return unless(run, relates(task_.variables[number], comparator_of(op), constant),
                      run->u8());
      }
  }
  return halt(Fault::kBadCode);
}

// Runs instructions until the program must wait or ends, or the budget, which is not 0, is used up. A
// computer on which somebody follows a program instruction by instruction counts these.
bool Machine::execute(uint8_t budget) {
  const uint8_t* const begin = code_ + task_.pc;
  Running run = {begin, begin, task_.stack + task_.depth, budget};
  bool goes_on;
  do {
    if (kCountsInstructions) run.left--;
    goes_on = step(&run);
  } while (goes_on && run.left != 0);
  at_ = offset(run.at);
  left_ = run.left;
  task_.pc = offset(run.next);
  task_.depth = static_cast<uint8_t>(run.top - task_.stack);
  return goes_on;
}

}  // namespace tiniscript

#endif
