// The machine.
//
// Runs verified code. Time comes in as `now_ms`; the world is accessed through `robot.h`. `tick`
// does a little and returns: nothing here blocks. In Python it is `machine.py`, whose `tick` counts
// instructions; `tests/project/test_twins.py` lists what has another name there. Its state of a
// program is in `state.h`, its moves in `drive.h`, the turns of tasks in `scheduler.h`;
// `inner_loop.cpp` runs an instruction at a time, `actions.cpp` the instructions that involve the
// robot.
//
// Cheap checks guard against unverified code: stack, counters, calls, offsets, opcodes and the
// numbers of variables and sensors. A violation is the fault kBadCode, not a wild write. On the AVR
// an instruction that should empty the stack empties it, and the target of a short jump back is
// checked when the machine leaves.

#pragma once

#include <stdint.h>

#include "bytecode.h"
#include "scheduler.h"
#include "small.h"
#include "state.h"

namespace tiniscript {

// The first kEnd ends the program. The others serve as operands if the last instruction of damaged
// code is cut off.
constexpr uint8_t kEndBytes = 4;

class Machine : public Scheduler {
 public:
  // Begins a program. `code` is verified for a kit with so many sensors (0 to kDevices), and
  // after its `length` bytes lie kEndBytes of Op::kEnd: whoever loads it puts them there. The
  // last reading of each sensor is kept in `readings`, which are 0. `seed` is not 0.
  void start(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
             uint32_t seed, uint32_t now_ms);

  // The two halves of `start`: the first one takes longer and does not depend on the program.
  void prepare();
  void start_prepared(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
                      uint32_t seed, uint32_t now_ms);

  // Runs at the time `now_ms` until the program must wait or ends, or for a `budget` of jumps back
  // and calls: code between two of them is short. In the assembly of an AVR a tick also ends there
  // early if `boards/avr/events.h` requests it. With `tiniscript_counts_instructions`, all count.
  Status tick(uint32_t now_ms, uint8_t budget);

  const Task& task() const { return task_; }
  bool has_tasks() const { return Execution::has_tasks(); }
  Status status() const { return status_; }
  Fault fault() const { return fault_; }

  // The begin of the instruction that runs or has faulted.
  uint16_t offset() const { return offset_; }

  // For breakpoints: `halt.cpp`, where kHasBreakpoints.

  uint16_t length() const { return length_; }

  // After kHalted: goes on with the instruction there, in whose place the kTrap no longer is. An
  // instruction of the text begins there, so the stack is empty.
  void resume();

  // The task whose turn it is, as the number of its record; invalid between two rounds.
  uint8_t turn() const;

  // Where a task continues. Where the innermost open call of the current task continues.
  uint16_t place_of(uint8_t task) const;
  uint16_t return_place() const;

  // Sets the motors again as the program has them, to what is left of a way.
  void set_motors_again();

  // The offset of the SHOW whose value `robot_show` gets, also if it gets it again: it is a byte,
  // and a task continues after it.
  uint16_t shown_at() const { return static_cast<uint16_t>(task_.pc - 1); }

  // When the machine has work again, while the program waits; of tasks it may be at once, or was.
  uint32_t wake_ms() const;

  // Goes on to where the next instruction begins. False: none may run now. Not for an AVR.
  bool reach_instruction(uint32_t now_ms);

  // The rest of the last budget.
  uint8_t budget_left() const { return budget_left_; }

 private:
  friend class InnerLoop;

  // Passes the time. Returns whether the program may run: a wait is over, or it has none.
  bool wake(uint32_t now_ms);
  bool is_due() const;

  // The program has a fault, or halts at a trap.
  tini_noinline Status end_in_fault();

  // Whether it has faulted at a kTrap.
  bool is_trapped() const {
    return kHasBreakpoints && fault_ == Fault::kBadCode && offset_ < length_ && code_[offset_] == kTrap;
  }

  // Whether a move that the robot measures has failed before an instruction runs.
  bool is_stuck() const { return kHasDiscs && fault_ != Fault::kNone; }

  // Runs turns until the round is over or the budget is used up: `turns.cpp`, `tasks_avr.S`.
  void run_round();

  // Runs what is left of a turn: `inner_loop.cpp`, `turn_avr.cpp`. Returns whether it may go on later.
  bool run_turn();

  // Runs instructions: `inner_loop.cpp`, `execute_avr.S`. Returns whether the next one may run now,
  // which the assembly lets its caller find out.
  bool execute(uint8_t budget);

  // Instructions that involve the robot, the clock or chance: `actions.cpp`.
  bool act(uint8_t code, const uint8_t* bytes, int32_t* top) tini_called_by_assembly;
  bool sense(uint8_t number) tini_called_by_assembly;
  bool go_ms(uint8_t code, int32_t* top);
  bool show(int32_t value);

  // It is never called: the compiler checks its assertions.
  static void check_layout();
};

}  // namespace tiniscript
