// The places where a program halts, and the steps of one that has halted.
//
// There is a kTrap in the code only while the machine runs: it is put in before each tick and taken
// out after it. So all code that reads or saves a program finds it as it was verified.
//
// A task halts once before a statement, however often it tries it: a reading that is late, a SHOW
// without room, the check of an UNTIL or a WHEN. It is in that statement until it is found elsewhere:
// at one of those that may be next, where there are traps, too, or after a tick.

#pragma once

#include <stdint.h>

#include "../vm/machine.h"
#include "statements.h"

namespace tiniscript {

constexpr uint8_t kMaxPlaces = 4;

class Breakpoints {
 public:
  // Sets all places of a program: offsets of 16 bits. False: no statement begins at one of them,
  // and nothing has changed.
  bool set(const uint8_t* code, uint16_t length, const uint8_t* places, uint8_t count);
  void forget_places() { count_ = 0; }
  bool has_places() const { return count_ != 0; }

  // A run begins, which has a code, or ends. Places that are not in that code are forgotten.
  void begin(uint8_t* code, uint16_t length);
  void end();

  // Whether `insert_traps` and `remove_traps` have work to do.
  bool are_on() const {
    return count_ != 0 || is_stepping_ || passed_place_ != kNoPlace || has_open_statement_;
  }

  // Whether traps are in the code.
  bool has_traps() const { return has_traps_; }

  void insert_traps(const Machine& machine) { exchange(machine.length()); }

  // Takes them out after the tick. Returns whether the program halts; it does only where it may.
  // Otherwise a halted machine continues.
  bool remove_traps(Machine* machine, Status status, bool may_halt);

  bool is_halted() const { return is_halted_; }

  // Lets a program that is halted go on: to a place, or as a step to the next statement of its task.
  // Its machine goes on with `resume`.
  void go_on(const Machine& machine, bool is_step);

 private:
  static constexpr uint8_t kAllTasks = kTasks + 1;

  void exchange(uint16_t length);
  void exchange_at(uint16_t place, uint16_t length, uint8_t* byte);
  bool is_place(uint16_t offset) const;
  void enter(const Machine& machine);
  void note_left_statements(const Machine& machine);

  uint8_t* code_;
  uint16_t places_[kMaxPlaces];
  uint8_t count_;
  bool is_halted_ : 1;
  bool is_stepping_ : 1;
  bool has_open_statement_ : 1;  // a task is in a statement
  bool has_traps_ : 1;
  uint8_t stepper_;                  // the task that steps
  uint16_t step_end_;                // where that ends, if the task is in no statement
  uint16_t passed_place_;            // where there is no trap in the next tick
  Statement statements_[kAllTasks];  // where each task has halted; its start may be kNoPlace
  // The original instructions where the traps are: of each place, of the step's end, and of both
  // ways on from each statement. It is kTrap if there is none.
  uint8_t bytes_[kMaxPlaces + 1 + 2 * kAllTasks];
};

}  // namespace tiniscript
