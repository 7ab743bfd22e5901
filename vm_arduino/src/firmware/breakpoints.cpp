#include "breakpoints.h"

#include "../link/frames.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

namespace {

bool may_be_next(const Statement& statement, uint16_t at) {
  return at == statement.end || at == statement.target;
}

bool contains(const Statement& statement, uint16_t at) {
  return statement.begin != kNoPlace && at >= statement.begin && at < statement.end;
}

}  // namespace

bool Breakpoints::set(const uint8_t* code, uint16_t length, const uint8_t* places, uint8_t count) {
  FoundStatement found;
  for (uint8_t k = 0; k < count; k++) {
    if (!find_statement(code, length, get16(places + 2 * k), &found)) return false;
  }
  for (uint8_t k = 0; k < count; k++) places_[k] = get16(places + 2 * k);
  count_ = count;
  return true;
}

void Breakpoints::begin(uint8_t* code, uint16_t length) {
  end();
  code_ = code;
  FoundStatement found;
  for (uint8_t k = 0; k < count_; k++) {
    if (!find_statement(code, length, places_[k], &found)) return forget_places();
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

// Puts a trap in, or takes it out. If a trap is already there, another one keeps the original
// instruction.
void Breakpoints::exchange_at(uint16_t place, uint16_t length, uint8_t* byte) {
  if (!are_in_) {
    *byte = kTrap;
    if (place >= length || place == passed_) return;
    *byte = code_[place];
    code_[place] = kTrap;
  } else if (*byte != kTrap) {
    code_[place] = *byte;
  }
}

// The same places work in both directions: they do not change while the traps are in.
void Breakpoints::exchange(uint16_t length) {
  uint8_t* byte = bytes_;
  for (uint8_t k = 0; k < count_; k++) exchange_at(places_[k], length, byte++);
  if (is_stepping_) exchange_at(step_end_, length, byte++);
  if (is_in_some_) {
    for (const Statement& statement : in_statement_) {
      if (statement.begin == kNoPlace) continue;
      exchange_at(statement.end, length, byte++);
      exchange_at(statement.target, length, byte++);
    }
  }
  are_in_ = !are_in_;
}

// The current task is in the statement before which it halts.
void Breakpoints::enter(const Machine& machine) {
  FoundStatement found;
  find_statement(code_, machine.length(), machine.offset(), &found);
  if (found.returns) found.statement.target = machine.return_place();
  in_statement_[machine.turn()] = found.statement;
  is_in_some_ = true;
}

// Finds out after a tick which tasks have left their statement. A stepping task halts before its
// next statement, or in a check, after which that is.
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
    FoundStatement next;
    const bool is_in_check = find_statement(code_, machine.length(), at, &next) && next.is_in_check;
    step_end_ = is_in_check ? next.statement.end : at;
  }
}

bool Breakpoints::take_out(Machine* machine, Status status, bool may_halt) {
  if (are_in_) exchange(machine->length());
  passed_ = kNoPlace;
  if (status != Status::kHalted) {
    note_left(*machine);
    return false;
  }
  const uint16_t at = machine->offset();
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
  passed_ = machine.offset();
  is_stepping_ = is_step;
  stepper_ = machine.turn();
}

}  // namespace tiniscript

#endif
