// The state of a running program: one small, plain record.
//
// Knows nothing of what instructions do. Times are milliseconds of a clock that may start
// anywhere and wraps around after 2^32; a wait is at most 2^31 long.

#ifndef TINISCRIPT_VM_TASK_H_
#define TINISCRIPT_VM_TASK_H_

#include <stdint.h>

#include "bytecode.h"

namespace tiniscript {

constexpr uint32_t kForever = 0xffffffff;  // the time of a move that only its UNTIL ends

// What `tick` returns.
enum class Status : uint8_t {
  kRunning,  // there is more to do now
  kWaiting,  // nothing to do before the machine's `wake_ms`
  kDone,
  kFault,
};

// What a task waits for.
enum class Wait : uint8_t {
  kNothing,
  kPause,  // the end of a wait or a beep, or the next check of an UNTIL
  kMove,   // the end of a move: then motors off
};

struct Task {
  uint16_t pc;
  uint8_t depth;   // values on `stack`
  uint8_t looped;  // of `counters`
  uint8_t called;  // of `calls`
  Wait wait;
  uint32_t random;
  uint32_t started_ms;
  uint32_t clock_ms;  // the program's own clock: where its last wait ended
  // the move that an UNTIL watches
  uint32_t move_ms;   // how long it may last, or kForever
  uint32_t begun_ms;  // when it began,
  uint16_t check;     // where its check begins
  bool is_watching;   // if it has
  bool drives;        // false: a wait, the motors stay as they are
  int8_t left;
  int8_t right;
  bool is_late;  // 2^31 ms have passed since the start: TIME can no longer express it
  int32_t variables[kVariables];
  // Everything from here on is written before it is read.
  int32_t stack[kStackValues + 1];  // the last one only lies after the values
  int32_t counters[kCounters];
  uint16_t calls[kCalls];  // where each open call continues
};

// What one task of a program with TASK and WHEN has for itself. A move of its own **drives**, or it
// is **blocked**: it waits for the motors, or stands still since a higher task has taken them.
struct TaskRecord {
  uint16_t pc;        // where its next turn begins
  uint16_t start;     // where it begins; a WHEN with its check
  uint16_t check;     // where that of its UNTIL begins, or where it goes on behind its move
  uint16_t after;     // behind the move; 0: behind its UNTIL
  uint32_t clock_ms;  // its own clock; its next turn is due then
  uint32_t rest_ms;   // of its move, behind `clock_ms`; or kForever
  int32_t unsent;     // the value of a SHOW that found no room
  int8_t left;        // of its move
  int8_t right;
  int8_t set_left;  // by its M
  int8_t set_right;
  uint8_t looped_at;  // where its counters begin, and how many there are
  uint8_t looped;
  uint8_t called_at;  // and its calls
  uint8_t called;
  bool is_when;
  bool has_ended;
  bool has_waited;  // since it last went back to the start of a loop
  bool has_unsent;
  bool is_unsent_yes_no;
  bool has_powers;  // its move has; false: a wait, the motors stay as they are
  bool has_begun;   // its move
  bool is_moving;   // its move drives or is blocked
  bool is_blocked;
  bool drives;
  bool to_its_end;  // the clock is the end of the move
  bool has_set;     // its M is in force
  bool keeps;       // a WHEN has wanted the motors, and has not found FALSE since

  bool wants_motors() const { return is_moving || has_set || keeps; }
};

constexpr uint8_t kNobody = 0xff;

// The tasks in the order of rank, the main task last. Where the one is whose turn it is, its clock
// and what is open of it are in Task.
struct Tasks {
  TaskRecord records[kTasks + 1];
  uint8_t count;  // 0: the program has none
  uint8_t me;     // whose turn it is, or was last
  uint8_t next;   // the next one of this round
  uint8_t holder;  // who has the motors, or kNobody
  int8_t left;    // what they were set to last
  int8_t right;
  bool is_in_turn;      // a turn has begun and is not over
  bool is_first;        // it is the first one of the main task, before all others
  bool is_first_round;  // the main task has had its turn in it
};

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_TASK_H_
