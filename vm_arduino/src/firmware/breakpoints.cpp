#include "breakpoints.h"

#include "../link/frames.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

namespace {

bool may_be_next(const Statement& statement, uint16_t at) {
  for (const uint16_t next : statement.next) {
    if (next == at) return true;
  }
  return false;
}

bool contains(const Statement& statement, uint16_t at) {
  return statement.begin != kNoPlace && at >= statement.begin && at < statement.end;
}

}  // namespace

bool Breakpoints::set(const uint8_t* code, uint16_t length, const uint8_t* places, uint8_t count) {
  Statement statement;
  for (uint8_t k = 0; k < count; k++) {
    if (!find_statement(code, length, get16(places + 2 * k), &statement)) return false;
  }
  for (uint8_t k = 0; k < count; k++) places_[k] = get16(places + 2 * k);
  count_ = count;
  return true;
}

void Breakpoints::begin(uint8_t* code, uint16_t length) {
  end();
  code_ = code;
  length_ = length;
  Statement statement;
  for (uint8_t k = 0; k < count_; k++) {
    if (!find_statement(code, length, places_[k], &statement)) return forget_places();
  }
}

void Breakpoints::end() {
  is_halted_ = is_stepping_ = is_in_some_ = false;
  passed_ = step_end_ = kNoPlace;
  for (Statement& statement : in_statement_) statement.begin = kNoPlace;
}

bool Breakpoints::is_place(uint16_t at) const {
  for (uint8_t k = 0; k < count_; k++) {
    if (places_[k] == at) return true;
  }
  return false;
}

void Breakpoints::put(uint16_t place) {
  if (place >= length_ || place == passed_ || code_[place] == kTrap) return;
  traps_[in_++] = {place, code_[place]};
  code_[place] = kTrap;
}

void Breakpoints::put_in() {
  for (uint8_t k = 0; k < count_; k++) put(places_[k]);
  if (is_stepping_) put(step_end_);
  if (!is_in_some_) return;
  for (const Statement& statement : in_statement_) {
    if (statement.begin == kNoPlace) continue;
    for (const uint16_t next : statement.next) put(next);
  }
}

// The task whose turn it is is in the statement before which it halts.
void Breakpoints::enter(const Machine& machine) {
  Statement& statement = in_statement_[machine.turn()];
  find_statement(code_, length_, machine.at(), &statement);
  if (statement.returns) statement.next[0] = machine.return_place();
  is_in_some_ = true;
}

// Finds out after a tick which tasks have left what they were in. One that steps waits before what
// comes next, or in a check, after which that is.
void Breakpoints::note_left(const Machine& machine) {
  is_in_some_ = false;
  for (uint8_t task = 0; task < kAllTasks; task++) {
    Statement& its = in_statement_[task];
    if (its.begin == kNoPlace) continue;
    const uint16_t at = machine.place_of(task);
    if (contains(its, at)) {
      is_in_some_ = true;
      continue;
    }
    its.begin = kNoPlace;
    if (!is_stepping_ || task != stepper_) continue;
    Statement next;
    const bool is_in_check = find_statement(code_, length_, at, &next) && next.is_in_check;
    step_end_ = is_in_check ? next.end : at;
  }
}

bool Breakpoints::take_out(Machine* machine, Status status, bool may_halt) {
  while (in_ != 0) {
    const Trap& trap = traps_[--in_];
    code_[trap.place] = trap.byte;
  }
  passed_ = kNoPlace;
  if (status != Status::kHalted) {
    note_left(*machine);
    return false;
  }
  const uint16_t at = machine->at();
  const uint8_t task = machine->turn();
  Statement& its = in_statement_[task];
  const bool is_new = its.begin != at;
  const bool was_in = its.begin != kNoPlace;
  const bool ends_step = is_stepping_ && task == stepper_ &&
                         (was_in ? may_be_next(its, at) : at == step_end_);
  if (is_new) its.begin = kNoPlace;
  if (may_halt && (ends_step || (is_new && is_place(at)))) {
    enter(*machine);
    is_halted_ = true;
    is_stepping_ = false;
    step_end_ = kNoPlace;
    return true;
  }
  // One that does not halt at its step's end ends that.
  if (ends_step) is_stepping_ = false;
  passed_ = at;
  machine->resume();
  return false;
}

void Breakpoints::go_on(const Machine& machine, bool is_step) {
  if (!is_halted_) return;
  is_halted_ = false;
  passed_ = machine.at();
  is_stepping_ = is_step;
  stepper_ = machine.turn();
}

}  // namespace tiniscript

#endif
