// The state of a running program: small, plain records.
//
// Knows nothing of what instructions do. Times are milliseconds of a clock that may start
// anywhere and wraps around after 2^32; a wait is at most 2^31 long.

#pragma once

#include <stdint.h>

#include "build.h"
#include "bytecode.h"
#include "layout_avr.h"

namespace tiniscript {

constexpr uint8_t kLateMs = 20;            // so late a move or wait may begin and lose nothing
constexpr uint32_t kForever = 0xffffffff;  // the time of a move that only its UNTIL ends

// The result of `tick`.
enum class Status : uint8_t {
  kRunning,  // there is more to do now
  kWaiting,  // nothing to do before the machine's `wake_ms`
  kDone,
  kFault,
  kHalted,  // in front of a kTrap, until `Machine::resume`
};

// In the place of an instruction's first byte: nothing of that instruction has happened. No
// instruction has this code.
constexpr uint8_t kTrap = 0xfe;

// Powers of both wheels in percent, the left one in the low byte.
using Powers = uint16_t;

constexpr Powers kMotorsOff = 0;

constexpr Powers powers_of(int8_t left, int8_t right) {
  return static_cast<uint16_t>(static_cast<uint8_t>(left) | static_cast<uint8_t>(right) << 8);
}

// The state of one task; a program without TASK and WHEN has one, the main task. A move of its own
// **drives**, or it is **blocked**: it waits for the motors, or stands still since a higher task
// has taken them.
struct TaskRecord {
  static constexpr uint8_t kWaits = 0x10;  // tells a wait from a move
  // in addition to the code
  static constexpr uint8_t kWatches = 0x20;   // an UNTIL follows
  static constexpr uint8_t kMeasures = 0x80;  // it lasts until the way is gone
  static constexpr uint8_t kFirstShow = static_cast<uint8_t>(Op::kShow);

  uint8_t state;        // bits, see below
  uint8_t code;         // of its move or wait; or of a SHOW that found no room
  int8_t power;         // of its move
  uint8_t frame_count;  // how many frames it has
  uint16_t pc;          // where its next turn begins
  uint16_t start;       // of a WHEN, its check; of others 0
  uint16_t check;       // where that of its UNTIL begins, or where it goes on after its move
  uint32_t clock_ms;    // its own clock; its next turn is due then
  uint32_t rest_ms;     // how long its move may last from then on, or kForever; or the value of
                        // the SHOW, or the way of a move that is measured
  Powers own_powers;    // by its M; of who has the motors, what they are set to

  bool is(uint8_t bits) const { return (state & bits) != 0; }
  bool is_move() const { return (code & kWaits) == 0; }
  bool is_watched() const { return (code & kWatches) != 0; }
  bool has_unsent() const { return static_cast<uint8_t>(code - kFirstShow) < 2; }
  bool shows_yes_no() const { return code != kFirstShow; }
  bool measures() const { return kHasDiscs && (code & kMeasures) != 0; }
  bool is_forever() const { return static_cast<int32_t>(rest_ms) < 0; }
};

// Bits of `state`.
constexpr uint8_t kIsMoving = 1;  // its move drives or is blocked
constexpr uint8_t kHasTime = 2;  // its clock says when it is due: it is not blocked, and has not ended
constexpr uint8_t kDrives = 4;
constexpr uint8_t kToItsEnd = 8;      // the clock is the end of the move
constexpr uint8_t kHasBegun = 16;     // it is neither blocked nor in the check before its move
constexpr uint8_t kHoldsPowers = 32;  // those of its M, which is in force
constexpr uint8_t kKeeps = 64;        // a WHEN has wanted the motors, and has not found FALSE since
constexpr uint8_t kHasWaited = 128;   // since it last went back to the start of a loop
constexpr uint8_t kWantsMotors = kIsMoving | kHoldsPowers | kKeeps;
constexpr uint8_t kAtFirst = kHasTime | kHasBegun;

// Bits of `other_tasks`.
constexpr uint8_t kIsFirstRound = 1;
constexpr uint8_t kOneOther = 2;     // the amount for each task that has not ended, except one
constexpr uint8_t kAllOthers = 14;
constexpr uint8_t kHasHadTurn = 64;   // the first turn, of the main task before all others, is over
constexpr uint8_t kHasOthers = 128;  // there are tasks besides the main one

// For an open counted loop: how many times it still repeats. For an open call: where it continues.
// They lie in the order in which they were opened.
template <bool kInAssembly>
struct FrameOf {
  using Type = int32_t;
};

template <>
struct FrameOf<true> {
  struct Type {
    uint8_t bytes[tini_frame_bytes];  // as `execute_avr.S` knows them
  };
};

using Frame = FrameOf<kInAssembly>::Type;

constexpr uint8_t kFrames = kCounters + kCalls;

template <bool kHasTasks>
struct TaskOf;

// For a program that may have tasks.
template <>
struct TaskOf<true> {
  uint16_t pc;
  uint8_t depth;        // values on `stack`
  uint8_t frame_count;  // of `frames`
  uint32_t random_state;
  uint32_t started_ms;
  bool is_late;         // 2^31 ms have passed since the start: TIME can no longer express it
  uint8_t other_tasks;  // bits, see above
  bool is_quiet;        // in this millisecond a round has gone by without a turn
  TaskRecord* current;  // whose turn it is; null: a round is over
  uint16_t move_end;    // after the move that drives, where its UNTIL looks again before
  TaskRecord* holder;   // who has the motors; where nobody wants them, the main task
  int32_t variables[kVariables];
  TaskRecord records[kTasks + 1];  // in the order of rank; the last one is the main task
  // Everything from here on is written before it is read.
  int32_t stack[kStackValues + 1];  // the last one only lies after the values
  Frame frames[kFrames];

  TaskRecord* main_task() { return records + kTasks; }
  void end_quiet() { is_quiet = false; }
  void note_powers(Powers powers) { holder->own_powers = powers; }
};

// The same where there is no room for tasks: the main one alone.
template <>
struct TaskOf<false> {
  uint16_t pc;
  uint8_t depth;
  uint8_t frame_count;
  uint32_t random_state;
  uint32_t started_ms;
  bool is_late;
  TaskRecord current[1];
  int32_t variables[kVariables];
  int32_t stack[kStackValues + 1];
  Frame frames[kFrames];

  static constexpr uint8_t other_tasks = 0;
  static constexpr bool is_quiet = false;
  static void end_quiet() {}
  static void note_powers(Powers) {}
};

using Task = TaskOf<kHasTasks>;

// A program that runs, as moves, turns and instructions share it. `layout_avr.h` knows where what
// lies.
class Execution {
 protected:
  bool has_tasks() const { return task_.other_tasks != 0; }

  // Whether it continues, without a fault.
  bool goes_on(Fault fault);

  // A run-time check has failed, which verified code never causes.
  bool fail();

  // Ends the turn, and in a program without tasks the tick.
  bool pause();

  // Ends the tick before this instruction; the next tick begins with it.
  bool stay();

  Status status_;
  Fault fault_;
  uint8_t sensors_;
  uint16_t offset_;
  uint8_t budget_left_;
  uint16_t length_;
  const uint8_t* code_;
  int32_t* readings_;
  uint32_t now_ms_;
  Task task_;
};

}  // namespace tiniscript
