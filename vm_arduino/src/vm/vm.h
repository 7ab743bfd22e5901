// The machine.
//
// Runs verified code. Time comes in as `now_ms`; the world is behind `robot.h`. `tick` does a
// little and returns: nothing here waits. The same names and order as `vm.py` and
// `vm_instructions.py`.
//
// What verified code never does is still looked at, cheaply: stack, counters, calls, offsets,
// opcodes and the numbers of variables and sensors. It is the fault kBadCode, not a wild write.

#ifndef TINISCRIPT_VM_VM_H_
#define TINISCRIPT_VM_VM_H_

#include <stdint.h>

#include "bytecode.h"
#include "task.h"

namespace tiniscript {

class Machine {
 public:
  // Begins a program. `code` is verified for a kit with so many sensors (0 to kDevices), and the
  // byte behind its `length` bytes is Op::kEnd: whoever loads it puts it there. `seed` is not 0.
  void start(const uint8_t* code, uint16_t length, uint8_t sensors, uint32_t seed, uint32_t now_ms);

  // Runs at most `budget` instructions at the time `now_ms`.
  Status tick(uint32_t now_ms, uint16_t budget);

  const Task& task() const { return task_; }
  Status status() const { return status_; }
  Fault fault() const { return fault_; }

  // Where the instruction that runs, or has faulted, begins.
  uint16_t at() const { return at_; }

  // How much of the last budget is left.
  uint16_t left() const { return left_; }

 private:
  void execute();
  void step();

  // waits, and what else stops a tick
  void wait(uint32_t duration_ms, Wait what);
  void sleep(uint32_t wake_ms, Wait what);
  void begin();
  void until(bool stop, uint16_t check);
  void retry();
  void raise(Fault fault);

  // operands and values
  int32_t* variable(uint8_t number);
  int32_t* sensor(uint8_t number, bool must_read);

  // what several instructions share
  void move(uint8_t code, uint16_t operand, const int32_t* values);
  void open_counter(int32_t count);
  bool count(bool drops);
  void compare_and_branch(uint8_t code, uint16_t operand);

  Status status_;
  Fault fault_;
  bool must_stop_;  // for now
  uint8_t sensors_;
  uint8_t depth_;  // of the stack, before the instruction that runs
  uint16_t at_;
  uint16_t left_;
  uint16_t length_;
  const uint8_t* code_;
  uint32_t now_ms_;
  Task task_;
};

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_VM_H_
