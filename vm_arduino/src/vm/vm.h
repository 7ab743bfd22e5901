// The machine.
//
// Runs verified code. Time comes in as `now_ms`; the world is behind `robot.h`. `tick` does a
// little and returns: nothing here waits. Means the same as `machine.py` and
// `instructions.py`.
//
// What verified code never does is still looked at, cheaply: stack, counters, calls, offsets,
// opcodes and the numbers of variables and sensors. It is the fault kBadCode, not a wild write.

#ifndef TINISCRIPT_VM_VM_H_
#define TINISCRIPT_VM_VM_H_

#include <stdint.h>

#include "bytecode.h"
#include "task.h"

namespace tiniscript {

// The first of them ends the program. The others are for damaged code, whose last instruction may
// be cut: they are read as its operands.
constexpr uint8_t kEndBytes = 4;

class Machine {
 public:
  // Begins a program. `code` is verified for a kit with so many sensors (0 to kDevices), and
  // behind its `length` bytes lie kEndBytes of Op::kEnd: whoever loads it puts them there. The
  // last reading of each sensor is kept in `readings`, which are 0. `seed` is not 0.
  void start(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
             uint32_t seed, uint32_t now_ms);

  // Runs at most `budget` instructions at the time `now_ms`.
  Status tick(uint32_t now_ms, uint8_t budget);

  const Task& task() const { return task_; }
  Status status() const { return status_; }
  Fault fault() const { return fault_; }

  // Where the instruction that runs, or has faulted, begins.
  uint16_t at() const { return at_; }

  // When there is something to do again, while the program waits.
  uint32_t wake_ms() const { return task_.clock_ms; }

  // How much of the last budget is left.
  uint8_t left() const { return left_; }

 private:
  // What an instruction changes of where the program is. It is in the task only between ticks.
  struct Running {
    uint16_t next;
    uint16_t at;
    uint8_t depth;
  };

  void execute(uint8_t budget);
  bool step(Running* run);
  bool goes_on(Fault fault);
  bool fail();
  bool stay(Running* run);
  bool jump(Running* run, uint16_t distance);
  bool jump_back(Running* run, uint16_t distance);

  // what several instructions share
  bool move(uint8_t code, uint16_t operand, const int32_t* values);
  bool sense(uint8_t number, bool must_read);
  uint16_t compare_and_branch(const uint8_t* bytes);

  // waits
  void wait(uint32_t duration_ms, Wait what);
  void sleep(uint32_t wake_ms, Wait what);
  void begin();
  void finish();
  bool watch();

  Status status_;
  Fault fault_;
  uint8_t sensors_;
  uint16_t at_;
  uint8_t left_;
  uint16_t length_;
  const uint8_t* code_;
  int32_t* readings_;
  uint32_t now_ms_;
  Task task_;
};

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_VM_H_
