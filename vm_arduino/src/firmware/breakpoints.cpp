#include "breakpoints.h"

#include "../link/frames.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

namespace {

bool may_be_next(const Statement& statement, uint16_t offset) {
  return offset == statement.end || offset == statement.target;
}

bool contains(const Statement& statement, uint16_t offset) {
  return statement.start != kNoPlace && offset >= statement.start && offset < statement.end;
}

}  // namespace

bool Breakpoints::set(const uint8_t* code, uint16_t length, const uint8_t* places, uint8_t count) {
  StatementInfo info;
  for (uint8_t k = 0; k < count; k++) {
    if (!find_statement(code, length, get16(places + 2 * k), &info)) return false;
  }
  for (uint8_t k = 0; k < count; k++) places_[k] = get16(places + 2 * k);
  count_ = count;
  return true;
}

void Breakpoints::begin(uint8_t* code, uint16_t length) {
  end();
  code_ = code;
  StatementInfo info;
  for (uint8_t k = 0; k < count_; k++) {
    if (!find_statement(code, length, places_[k], &info)) return forget_places();
  }
}

void Breakpoints::end() {
  is_halted_ = is_stepping_ = has_open_statement_ = false;
  passed_place_ = step_end_ = kNoPlace;
  for (Statement& statement : statements_) statement.start = kNoPlace;
}

bool Breakpoints::is_place(uint16_t offset) const {
  for (uint8_t k = 0; k < count_; k++) {
    if (places_[k] == offset) return true;
  }
  return false;
}

// Puts a trap in, or takes it out. If a trap is already there, another one keeps the original
// instruction.
void Breakpoints::exchange_at(uint16_t place, uint16_t length, uint8_t* byte) {
  if (!has_traps_) {
    *byte = kTrap;
    if (place >= length || place == passed_place_) return;
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
  if (has_open_statement_) {
    for (const Statement& statement : statements_) {
      if (statement.start == kNoPlace) continue;
      exchange_at(statement.end, length, byte++);
      exchange_at(statement.target, length, byte++);
    }
  }
  has_traps_ = !has_traps_;
}

// The current task is in the statement before which it halts.
void Breakpoints::enter(const Machine& machine) {
  StatementInfo info;
  find_statement(code_, machine.length(), machine.offset(), &info);
  if (info.returns) info.statement.target = machine.return_place();
  statements_[machine.turn()] = info.statement;
  has_open_statement_ = true;
}

// Finds out after a tick which tasks have left their statement. A stepping task halts before its
// next statement, or in a check, after which that is.
void Breakpoints::note_left_statements(const Machine& machine) {
  has_open_statement_ = false;
  for (uint8_t task = 0; task < kAllTasks; task++) {
    Statement& statement = statements_[task];
    if (statement.start == kNoPlace) continue;
    const uint16_t offset = machine.place_of(task);
    if (contains(statement, offset)) {
      has_open_statement_ = true;
      continue;
    }
    statement.start = kNoPlace;
    if (!is_stepping_ || task != stepper_) continue;
    StatementInfo info;
    const bool is_in_check =
        find_statement(code_, machine.length(), offset, &info) && info.is_in_check;
    step_end_ = is_in_check ? info.statement.end : offset;
  }
}

bool Breakpoints::remove_traps(Machine* machine, Status status, bool may_halt) {
  if (has_traps_) exchange(machine->length());
  passed_place_ = kNoPlace;
  if (status != Status::kHalted) {
    note_left_statements(*machine);
    return false;
  }
  const uint16_t offset = machine->offset();
  const uint8_t task = machine->turn();
  Statement& statement = statements_[task];
  const bool is_new = statement.start != offset;
  const bool was_in = statement.start != kNoPlace;
  const bool ends_step = is_stepping_ && task == stepper_ &&
                         (was_in ? may_be_next(statement, offset) : offset == step_end_);
  if (is_new) statement.start = kNoPlace;
  if (may_halt && (ends_step || (is_new && is_place(offset)))) {
    enter(*machine);
    is_halted_ = true;
    is_stepping_ = false;
    step_end_ = kNoPlace;
    return true;
  }
  // One that does not halt at its step's end ends that.
  if (ends_step) is_stepping_ = false;
  passed_place_ = offset;
  machine->resume();
  return false;
}

void Breakpoints::go_on(const Machine& machine, bool is_step) {
  if (!is_halted_) return;
  is_halted_ = false;
  passed_place_ = machine.offset();
  is_stepping_ = is_step;
  stepper_ = machine.turn();
}

}  // namespace tiniscript

#endif
