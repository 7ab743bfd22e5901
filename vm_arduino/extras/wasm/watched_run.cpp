// The run of a program, which a virtual robot can hold in front of an instruction.
//
// Stands for `run.cpp` in its module. A held program waits within a tick, and goes on with the
// rest of that tick's budget: so it does the same at the same times as one that was never held.
// Where no mark is wanted, the machine runs as on a robot.

#include "watched_run.h"

#include "../../src/firmware/halting.h"
#include "../../src/firmware/program.h"
#include "../../src/vm/machine.h"

namespace tiniscript {

namespace {

uint8_t marks[kImageBytes];  // bits for each offset of the code
uint8_t wanted_marks;        // a program is held at the marks that have one of these bits
uint8_t held_budget;         // of the budget of the tick in which it is held
bool is_held;
bool has_held;                       // since `watched_begin`
bool is_passing;                     // the instruction in front of which it was held
int32_t last_variables[kVariables];  // of a program that has ended, once the machine is reset
bool is_reset;

class HeldMachine : public Machine {
 public:
  void prepare() {
    for (uint8_t k = 0; k < kVariables; k++) last_variables[k] = task().variables[k];
    is_reset = true;
    Machine::prepare();
  }

  void start_prepared(const uint8_t* code, uint16_t length, int32_t* readings, uint8_t sensors,
                      uint32_t seed, uint32_t now_ms) {
    is_held = false;
    is_passing = false;
    held_budget = 0;
    is_reset = false;
    Machine::start_prepared(code, length, readings, sensors, seed, now_ms);
  }

  Status tick(uint32_t now_ms, uint8_t budget) {
    if (is_held) return status();
    if (held_budget != 0) budget = held_budget;
    held_budget = 0;
    Status result;
    if (wanted_marks == 0) {
      result = Machine::tick(now_ms, budget);
      is_passing = is_passing &&
                   budget_left() == budget;  // where nothing is wanted now, something may be later
      return result;
    }
    do {
      if (has_tasks() && !reach_instruction(now_ms)) return status();
      if (is_marked(now_ms)) {
        is_held = true;
        has_held = true;
        held_budget = budget;
        return Status::kRunning;
      }
      result = Machine::tick(now_ms, 1);
      budget = static_cast<uint8_t>(budget - 1 + budget_left());
      is_passing = is_passing && budget_left() != 0;  // a SHOW that waits for room to be sent
    } while (budget != 0 && result == Status::kRunning && budget_left() == 0);
    return result;
  }

 private:
  // Whether the program waits for a later time.
  bool is_early(uint32_t now_ms) const {
    return status() == Status::kWaiting && static_cast<int32_t>(now_ms - wake_ms()) < 0;
  }

  bool is_marked(uint32_t now_ms) const {
    const uint16_t offset = task().pc;
    return !is_passing && !is_early(now_ms) && offset < kImageBytes &&
           (marks[offset] & wanted_marks) != 0;
  }
};

}  // namespace

}  // namespace tiniscript

#define Machine HeldMachine

#include "../../src/firmware/run.cpp"

#undef Machine

namespace tiniscript {

uint8_t* watched_marks() { return marks; }

uint32_t watched_marks_bytes() { return kImageBytes; }

void watched_want(uint8_t bits) { wanted_marks = bits; }

void watched_begin() { has_held = false; }

bool watched_has_held() { return has_held; }

uint32_t watched_held_at() { return is_held && is_running() ? machine.task().pc : kNowhere; }

void watched_go_on() {
  if (!is_held) return;
  is_held = false;
  is_passing = true;
  if (is_running()) go_on();
}

const int32_t* watched_tasks() {
  static int32_t places[1 + kTasks + 1];
  places[0] = 0;
#ifdef tiniscript_has_tasks
  if (!is_running() || !machine.has_tasks()) return places;
  const Task& task = machine.task();
  for (const TaskRecord& record : task.records) {
    const uint16_t offset = &record == task.current ? task.pc : record.pc;
    if (record.state != 0 && offset != 0) places[++places[0]] = offset - 1;
  }
#endif
  return places;
}

uint32_t watched_driver() {
#ifdef tiniscript_has_tasks
  if (!is_running() || !machine.has_tasks() || !is_driving()) return kNowhere;
  const Task& task = machine.task();
  const uint16_t offset = task.holder == task.current ? task.pc : task.holder->pc;
  if (offset != 0) return offset - 1u;
#endif
  return kNowhere;
}

const int32_t* watched_variables() { return is_reset ? last_variables : machine.task().variables; }

}  // namespace tiniscript
