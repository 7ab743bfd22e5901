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

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_TASK_H_
