// Code shared by instructions, copied into the inner loop in `inner_loop.cpp`.
//
// Not for the AVR. Each function returns whether the next instruction may run now.

#pragma once

#include <stdint.h>

#include "arithmetic.h"
#include "decode_form.h"
#include "machine.h"
#include "number.h"
#include "small.h"

namespace tiniscript {

// The position in the program while the inner loop runs. It is in the machine only between ticks and
// during `act`: nothing that is called gets the address of an InnerLoop, so it stays in registers.
class InnerLoop {
 public:
  InnerLoop(Machine* machine, uint8_t budget);

  // Runs one instruction.
  bool step();

  // Whether the budget is used up.
  bool is_over() const { return budget_left_ == 0; }

  // Leaves its position in the machine.
  void end();

 private:
  // The next operand.
  tini_always_inline uint8_t u8() { return *next_++; }
  tini_always_inline int8_t i8() { return static_cast<int8_t>(u8()); }
  tini_always_inline uint16_t u16() {
    const uint8_t low = u8();
    return static_cast<uint16_t>(low | u8() << 8);
  }
  tini_always_inline int16_t i16() { return static_cast<int16_t>(u16()); }

  uint16_t offset(const uint8_t* byte) const;
  bool fail(Fault fault);
  bool pop(uint8_t values);
  bool push(int32_t value);
  bool leave(Fault fault);
  bool jump(uint16_t distance);
  bool jump_back(uint16_t distance);
  bool repeat_loop(uint16_t distance);
  bool jump_unless(bool holds, uint16_t distance);
  bool join(bool deciding_value, uint16_t distance);
  bool stay();
  bool act(uint8_t code, uint8_t pops, uint8_t size);
  bool act(uint8_t code);
  bool until(bool stop);
  bool until_relates(Op op, int32_t constant);
  bool jump_unless_relates(Op op, int32_t constant);
  bool jump_unless_variable_relates(uint8_t number, Op op, int32_t constant);
  bool push_variable(uint8_t number);
  bool push_sensor(uint8_t number);
  bool push_read(uint8_t number);
  bool set_variable(uint8_t number);
  bool add_to(uint8_t number, int32_t addend);
  bool open(Frame frame);
  bool loop(uint16_t distance);
  bool next_round(uint16_t distance);
  bool break_loop(uint16_t distance);
  bool call(uint16_t distance);
  bool read(uint8_t number);

  Machine& machine_;
  const uint8_t* start_;  // where the instruction begins
  const uint8_t* next_;   // its next operand, then the next instruction
  int32_t* top_;          // after the topmost value of the stack
  uint8_t budget_left_;   // of the budget
};

tini_always_inline InnerLoop::InnerLoop(Machine* machine, uint8_t budget)
    : machine_(*machine),
      start_(machine->code_ + machine->task_.pc),
      next_(start_),
      top_(machine->task_.stack + machine->task_.depth),
      budget_left_(budget) {}

tini_always_inline void InnerLoop::end() {
  machine_.offset_ = offset(start_);
  machine_.budget_left_ = budget_left_;
  machine_.task_.pc = offset(next_);
  machine_.task_.depth = static_cast<uint8_t>(top_ - machine_.task_.stack);
}

// Ends the program with a fault.
tini_always_inline bool InnerLoop::fail(Fault fault) {
  machine_.fault_ = fault;
  return false;
}

// The operands of an instruction are then at `top_`, the first value first.
tini_always_inline bool InnerLoop::pop(uint8_t values) {
  if (top_ < machine_.task_.stack + values) return fail(Fault::kBadCode);
  top_ -= values;
  return true;
}

// Pushes a value, if there is room.
tini_always_inline bool InnerLoop::push(int32_t value) {
  if (top_ == machine_.task_.stack + kStackValues) return fail(Fault::kBadCode);
  *top_++ = value;
  return true;
}

// Leaves what was calculated at `top_`.
tini_always_inline bool InnerLoop::leave(Fault fault) {
  top_++;
  return fault == Fault::kNone || fail(fault);
}

// The place of a byte in the code.
tini_always_inline uint16_t InnerLoop::offset(const uint8_t* byte) const {
  return static_cast<uint16_t>(byte - machine_.code_);
}

// Jumps by this many bytes forward or back from the end of the instruction. The target is checked
// when the next instruction begins.
tini_always_inline bool InnerLoop::jump(uint16_t distance) {
  next_ += distance;
  return true;
}

tini_always_inline bool InnerLoop::jump_back(uint16_t distance) {
  if (!kCountsInstructions) budget_left_--;
  next_ -= distance;
  return true;
}

// Goes back to the start of a loop.
tini_always_inline bool InnerLoop::repeat_loop(uint16_t distance) {
  jump_back(distance);
  return !machine_.has_tasks() || machine_.go_back();
}

// Continues with the next instruction if a condition holds, otherwise jumps.
tini_always_inline bool InnerLoop::jump_unless(bool holds, uint16_t distance) {
  return holds || jump(distance);
}

// Ends the tick before this instruction; the next tick begins with it.
tini_always_inline bool InnerLoop::stay() {
  next_ = start_;
  return false;
}

// Lets `act` and `until` see where the program is, and go elsewhere.
tini_always_inline bool InnerLoop::act(uint8_t code, uint8_t pops, uint8_t size) {
  int32_t* const top = top_ - 1;
  if (!pop(pops)) return false;
  machine_.offset_ = offset(start_);
  machine_.task_.pc = static_cast<uint16_t>(machine_.offset_ + size);
  const bool goes_on = machine_.act(code, start_, top);
  next_ = machine_.code_ + machine_.task_.pc;
  return goes_on;
}

tini_always_inline bool InnerLoop::act(uint8_t code) {
  const DecodeForm form = decode_form_of(code);
  return act(code, form.pops(), form.size());
}

tini_always_inline bool InnerLoop::until(bool stop) {
  machine_.task_.pc = offset(next_);
  const bool goes_on = machine_.until(stop);
  next_ = machine_.code_ + machine_.task_.pc;
  return goes_on;
}

// The instructions that compare with a constant.
tini_always_inline bool InnerLoop::until_relates(Op op, int32_t constant) {
  return pop(1) && until(relates(*top_, comparator_of(op), constant));
}

tini_always_inline bool InnerLoop::jump_unless_relates(Op op, int32_t constant) {
  return pop(1) && jump_unless(relates(*top_, comparator_of(op), constant), u8());
}

tini_always_inline bool InnerLoop::jump_unless_variable_relates(uint8_t number, Op op,
                                                                int32_t constant) {
  if (number >= kVariables) return fail(Fault::kBadCode);
  return jump_unless(relates(machine_.task_.variables[number], comparator_of(op), constant), u8());
}

// Variables and sensors: their numbers are checked, as damaged code may have any.
tini_always_inline bool InnerLoop::push_variable(uint8_t number) {
  return number < kVariables ? push(machine_.task_.variables[number]) : fail(Fault::kBadCode);
}

tini_always_inline bool InnerLoop::push_sensor(uint8_t number) {
  return number < machine_.sensors_ ? push(machine_.readings_[number]) : fail(Fault::kBadCode);
}

tini_always_inline bool InnerLoop::push_read(uint8_t number) {
  return machine_.sense(number) ? push(machine_.readings_[number]) : stay();
}

// Takes a reading; the value stays with the robot.
tini_always_inline bool InnerLoop::read(uint8_t number) {
  return machine_.sense(number) || stay();
}

tini_always_inline bool InnerLoop::set_variable(uint8_t number) {
  if (!pop(1)) return false;
  if (number >= kVariables) return fail(Fault::kBadCode);
  machine_.task_.variables[number] = *top_;
  return true;
}

tini_always_inline bool InnerLoop::add_to(uint8_t number, int32_t addend) {
  if (number >= kVariables) return fail(Fault::kBadCode);
  int32_t* const variable = machine_.task_.variables + number;
  const Fault fault = sum(*variable, addend, variable);
  return fault == Fault::kNone || fail(fault);
}

// Loops and calls.
tini_always_inline bool InnerLoop::open(Frame frame) {
  if (machine_.task_.frame_count >= kFrames) return fail(Fault::kBadCode);
  machine_.task_.frames[machine_.task_.frame_count++] = frame;
  return true;
}

tini_always_inline bool InnerLoop::loop(uint16_t distance) {
  if (!pop(1)) return false;
  const int32_t times = whole(*top_);
  return times < 1 ? jump(distance) : open(times);
}

tini_always_inline bool InnerLoop::next_round(uint16_t distance) {
  if (machine_.task_.frame_count == 0) return fail(Fault::kBadCode);
  if (--machine_.task_.frames[machine_.task_.frame_count - 1] != 0) return repeat_loop(distance);
  machine_.task_.frame_count--;
  return true;
}

tini_always_inline bool InnerLoop::break_loop(uint16_t distance) {
  if (machine_.task_.frame_count == 0) return fail(Fault::kBadCode);
  machine_.task_.frame_count--;
  return jump(distance);
}

tini_always_inline bool InnerLoop::call(uint16_t distance) {
  return open(offset(next_)) && jump_back(distance);
}

// Leaves the value on the stack and jumps if it is `deciding_value`, otherwise drops it.
tini_always_inline bool InnerLoop::join(bool deciding_value, uint16_t distance) {
  if (!pop(1)) return false;
  if ((*top_ != 0) != deciding_value) return true;
  top_++;
  return jump(distance);
}

}  // namespace tiniscript
