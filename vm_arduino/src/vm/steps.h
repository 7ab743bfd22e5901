// What instructions have in common, copied into the inner loop in `vm_instructions.cpp`.
//
// Not for the AVR. Each function returns whether the next instruction may run now.

#pragma once

#include <stdint.h>

#include "arithmetic.h"
#include "decode_form.h"
#include "number.h"
#include "small.h"
#include "vm.h"

namespace tiniscript {

// Ends the program.
tini_always_inline bool Machine::halt(Fault fault) {
  fault_ = fault;
  return false;
}

// What an instruction takes from the stack lies at `run->top` then, the first value first.
tini_always_inline bool Machine::pop(Running* run, uint8_t values) {
  if (run->top < task_.stack + values) return halt(Fault::kBadCode);
  run->top -= values;
  return true;
}

// Pushes a value, if there is room.
tini_always_inline bool Machine::push(Running* run, int32_t value) {
  if (run->top == task_.stack + kStackValues) return halt(Fault::kBadCode);
  *run->top++ = value;
  return true;
}

// Leaves what was calculated at `run->top`.
tini_always_inline bool Machine::leave(Running* run, Fault fault) {
  run->top++;
  return fault == Fault::kNone || halt(fault);
}

// The place of a byte in the code.
tini_always_inline uint16_t Machine::offset(const uint8_t* at) const {
  return static_cast<uint16_t>(at - code_);
}

// Jumps by this many bytes forward or back from the end of the instruction. Where that leads is
// checked when the next instruction begins.
tini_always_inline bool Machine::jump(Running* run, uint16_t distance) {
  run->next += distance;
  return true;
}

tini_always_inline bool Machine::jump_back(Running* run, uint16_t distance) {
  if (!kCountsInstructions) run->left--;
  run->next -= distance;
  return true;
}

// Goes back to the start of a loop.
tini_always_inline bool Machine::again(Running* run, uint16_t distance) {
  jump_back(run, distance);
  return !has_tasks() || goes_back();
}

// Goes on with the next instruction if a condition holds, else jumps.
tini_always_inline bool Machine::unless(Running* run, bool holds, uint16_t distance) {
  return holds || jump(run, distance);
}

// Ends the tick before this instruction; the next tick begins with it.
tini_always_inline bool Machine::stay(Running* run) {
  run->next = run->at;
  return false;
}

// Lets `act` and `until` see where the program is, and go elsewhere.
tini_always_inline bool Machine::act(Running* run, uint8_t code) {
  const DecodeForm form = decode_form_of(code);
  int32_t* const top = run->top - 1;
  if (!pop(run, form.pops())) return false;
  at_ = offset(run->at);
  task_.pc = static_cast<uint16_t>(at_ + form.size());
  const bool goes_on = act(code, run->at, top);
  run->next = code_ + task_.pc;
  return goes_on;
}

// GO or WATCH_GO, in two bytes.
tini_always_inline bool Machine::way(Running* run) {
  run->next++;
  int32_t* const top = run->top - 1;
  if (!pop(run, 2)) return false;
  at_ = offset(run->at);
  task_.pc = offset(run->next);
  const bool goes_on = act(static_cast<uint8_t>(Op::kEscape), run->at, top);
  run->next = code_ + task_.pc;
  return goes_on;
}

tini_always_inline bool Machine::until(Running* run, bool stop) {
  task_.pc = offset(run->next);
  const bool goes_on = until(stop);
  run->next = code_ + task_.pc;
  return goes_on;
}

// Variables and sensors: their numbers are checked, as damaged code may have any.
tini_always_inline bool Machine::push_variable(Running* run, uint8_t number) {
  return number < kVariables ? push(run, task_.variables[number]) : halt(Fault::kBadCode);
}

tini_always_inline bool Machine::push_sensor(Running* run, uint8_t number) {
  return number < sensors_ ? push(run, readings_[number]) : halt(Fault::kBadCode);
}

tini_always_inline bool Machine::push_read(Running* run, uint8_t number) {
  return sense(number) ? push(run, readings_[number]) : stay(run);
}

tini_always_inline bool Machine::set_variable(Running* run, uint8_t number) {
  if (!pop(run, 1)) return false;
  if (number >= kVariables) return halt(Fault::kBadCode);
  task_.variables[number] = *run->top;
  return true;
}

tini_always_inline bool Machine::add_to(uint8_t number, int32_t more) {
  if (number >= kVariables) return halt(Fault::kBadCode);
  int32_t* const variable = task_.variables + number;
  const Fault fault = sum(*variable, more, variable);
  return fault == Fault::kNone || halt(fault);
}

// Loops and calls.
tini_always_inline bool Machine::open(Frame frame) {
  if (task_.framed >= kFrames) return halt(Fault::kBadCode);
  task_.frames[task_.framed++] = frame;
  return true;
}

tini_always_inline bool Machine::loop(Running* run, uint16_t distance) {
  if (!pop(run, 1)) return false;
  const int32_t times = whole(*run->top);
  return times < 1 ? jump(run, distance) : open(times);
}

tini_always_inline bool Machine::next(Running* run, uint16_t distance) {
  if (task_.framed == 0) return halt(Fault::kBadCode);
  if (--task_.frames[task_.framed - 1] != 0) return again(run, distance);
  task_.framed--;
  return true;
}

tini_always_inline bool Machine::break_loop(Running* run, uint16_t distance) {
  if (task_.framed == 0) return halt(Fault::kBadCode);
  task_.framed--;
  return jump(run, distance);
}

tini_always_inline bool Machine::call(Running* run, uint16_t distance) {
  return open(offset(run->next)) && jump_back(run, distance);
}

// Leaves the value on the stack and jumps if it is `decisive`, else drops it.
tini_always_inline bool Machine::join(Running* run, bool decisive, uint16_t distance) {
  if (!pop(run, 1)) return false;
  if ((*run->top != 0) != decisive) return true;
  run->top++;
  return jump(run, distance);
}

}  // namespace tiniscript
