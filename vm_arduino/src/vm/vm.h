// The machine.
//
// Runs verified code. Time comes in as `now_ms`; the world is behind `robot.h`. `tick` does a
// little and returns: nothing here blocks. Matches `machine.py`.
//
// Cheap checks guard against unverified code: stack, counters, calls, offsets, opcodes and the
// numbers of variables and sensors. A violation is the fault kBadCode, not a wild write. On the AVR
// an instruction that should empty the stack empties it, and the target of a short jump back is
// checked when the machine leaves.

#pragma once

#include <stdint.h>

#include "bytecode.h"
#include "small.h"
#include "task.h"

namespace tiniscript {

// The first kEnd ends the program. The others serve as operands if the last instruction of damaged
// code is cut off.
constexpr uint8_t kEndBytes = 4;

// The budget of a tick in a main loop. An AVR leaves it where an interrupt wants attention.
#ifdef __AVR__
constexpr uint8_t kTickBudget = 255;
#else
constexpr uint8_t kTickBudget = 32;
#endif

#ifdef tiniscript_counts_instructions
constexpr bool kCountsInstructions = true;
#else
constexpr bool kCountsInstructions = false;
#endif

class Machine {
 public:
  // Begins a program. `code` is verified for a kit with so many sensors (0 to kDevices), and
  // behind its `length` bytes lie kEndBytes of Op::kEnd: whoever loads it puts them there. The
  // last reading of each sensor is kept in `readings`, which are 0. `seed` is not 0.
  void start(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
             uint32_t seed, uint32_t now_ms);

  // The two halves of `start`: the first one takes longer and does not depend on the program.
  void prepare();
  void start_prepared(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
                      uint32_t seed, uint32_t now_ms);

  // Runs at the time `now_ms` until the program must wait or ends, or for a `budget` of jumps back and
  // calls: code between two of them is short. In the assembly of an AVR a tick also ends there early
  // if `boards/avr/attention.h` requests it. With `tiniscript_counts_instructions` all count.
  Status tick(uint32_t now_ms, uint8_t budget);

  const Task& task() const { return task_; }
  bool has_tasks() const;
  Status status() const { return status_; }
  Fault fault() const { return fault_; }

  // The begin of the instruction that runs or has faulted.
  uint16_t at() const { return at_; }

  // When the machine has work again, while the program waits; of tasks it may be at once, or was.
  uint32_t wake_ms() const;

  // Goes on to where the next instruction begins. False: none may run now.
  bool arrive(uint32_t now_ms);

  // What is left of the last budget.
  uint8_t left() const { return left_; }

 private:
  // The position in the program while the inner loop runs. It is in the task only between ticks and
  // during `act`.
  struct Running {
    const uint8_t* at;    // where the instruction begins
    const uint8_t* next;  // its next operand, then the next instruction
    int32_t* top;         // behind the topmost value of the stack
    uint8_t left;         // of the budget

    tini_always_inline uint8_t u8() { return *next++; }
    tini_always_inline int8_t i8() { return static_cast<int8_t>(u8()); }
    tini_always_inline uint16_t u16() {
      const uint8_t low = u8();
      return static_cast<uint16_t>(low | u8() << 8);
    }
    tini_always_inline int16_t i16() { return static_cast<int16_t>(u16()); }
  };

  // The inner loop, in `vm_instructions.cpp`; in assembly it is `execute_avr.S`, which knows where
  // members lie.
#ifdef tiniscript_in_assembly
  void execute(uint8_t budget);
#else
  bool execute(uint8_t budget);  // returns whether the next instruction may run now
#endif

  // What it is made of, in `steps.h`.
  bool step(Running* run);
  bool halt(Fault fault);
  uint16_t offset(const uint8_t* at) const;
  bool pop(Running* run, uint8_t values);
  bool push(Running* run, int32_t value);
  bool leave(Running* run, Fault fault);
  bool jump(Running* run, uint16_t distance);
  bool jump_back(Running* run, uint16_t distance);
  bool again(Running* run, uint16_t distance);
  bool unless(Running* run, bool holds, uint16_t distance);
  bool join(Running* run, bool decisive, uint16_t distance);
  bool stay(Running* run);
  bool act(Running* run, uint8_t code);
  bool way(Running* run);
  bool until(Running* run, bool stop);
  bool push_variable(Running* run, uint8_t number);
  bool push_sensor(Running* run, uint8_t number);
  bool push_read(Running* run, uint8_t number);
  bool set_variable(Running* run, uint8_t number);
  bool add_to(uint8_t number, int32_t more);
  bool open(Frame frame);
  bool loop(Running* run, uint16_t distance);
  bool next(Running* run, uint16_t distance);
  bool break_loop(Running* run, uint16_t distance);
  bool call(Running* run, uint16_t distance);
  void check_places();

  // what asks something of the robot, of the clock or of chance, in `vm_robot.cpp`
  bool act(uint8_t code, const uint8_t* bytes, int32_t* top) tini_called_by_assembly;
  bool until(bool stop) tini_called_by_assembly;
  bool sense(uint8_t number) tini_called_by_assembly;
  bool go_ms(uint8_t code, int32_t* top);
  bool show(int32_t value);
  bool sends() tini_called_by_assembly;

  uint32_t late_ms(const TaskRecord* task) const;
  bool is_due() const;
  bool may_go_on(uint32_t now_ms);
  bool goes_on(Fault fault);
  bool fail();
  bool stay();

  // the turns of tasks, in `vm_tasks.cpp`
  void find_tasks();
  void run_round();
  bool finds_turn(bool is_over);
  bool begin_turn(TaskRecord* me);
  void end_turn();
  bool waits_for_clock(const TaskRecord* task) const;
  uint32_t next_turn_ms() const;
  void begin_others();
  void end_round();
  bool pause();
  bool goes_back();
  bool look(bool holds);
  bool look_again();
  bool ends_program();

  // their moves and motors, in `vm_moves.cpp`
  bool wait(uint32_t duration_ms) tini_called_by_assembly;
  bool drive(uint32_t move_ms);
  bool watch(uint32_t move_ms);
  void keep_move(uint32_t move_ms);
  void set_clock(TaskRecord* task) const;
  void begin(TaskRecord* me) const;
  uint32_t next_check_ms(const TaskRecord* me) const;
  bool go_on() tini_called_by_assembly;
  void go_way();
  bool is_on_the_way();
  bool comes_to_end() tini_called_by_assembly;
  void end_move();
  void leave_move(TaskRecord* task);
  void stand_still(TaskRecord* task);
  bool blocks() tini_called_by_assembly;
  void motors(Powers powers);
  void stop_motors();
  bool is_below() const;  // whether a higher task has the motors
  TaskRecord* main_task();
  bool has_had_turn() const;  // the main task, before all others
  void take();
  void pass_on();
  void set_motors(Powers powers) tini_called_by_assembly;
  void set_motors_of_move();

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
#ifdef tiniscript_has_discs
  TaskRecord* on_way_;  // whose way the robot measures, or measured last, unless its move is over
#endif
};

#ifdef tiniscript_has_tasks
inline bool Machine::has_tasks() const { return task_.others != 0; }
inline bool Machine::is_below() const { return task_.holder < task_.me; }
inline TaskRecord* Machine::main_task() { return task_.records + kTasks; }
inline bool Machine::has_had_turn() const { return (task_.others & kHasHadTurn) != 0; }
#else
inline bool Machine::has_tasks() const { return false; }
inline bool Machine::is_below() const { return false; }
#endif

}  // namespace tiniscript
