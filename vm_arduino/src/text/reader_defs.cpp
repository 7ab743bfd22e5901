// Additional parts of the reader for robots with more flash: DEFs and their calls, tasks, and moves
// by CM and DEG.

#include "reader_parts.h"

#ifdef tiniscript_reads_defs

namespace tiniscript {

// Opens a DEF or a task, which runs in parallel with the main task. The depths of that wait in its
// block.
void Reader::open_routine(uint8_t type, uint8_t end_operand) {
  open(type, end_operand);
  if (problem_ != Problem::kNone) return;
  Block* const block = top();
  block->read_after = static_cast<SensorBits>(max_blocks_ | calls_ << 8);
  block->known_before = static_cast<SensorBits>(other_blocks_ | other_calls_ << 8);
  // The needs of a DEF count where it is called.
  const bool is_def = type == kDefBlock;
  other_blocks_ = is_def ? uint8_t{0} : static_cast<uint8_t>(other_blocks_ + max_blocks_);
  other_calls_ = is_def ? uint8_t{0} : static_cast<uint8_t>(other_calls_ + calls_);
  max_blocks_ = calls_ = 0;
}

// A DEF or a task ends.
void Reader::close_routine(Block* block) {
  const bool is_def = block->type == kDefBlock;
  if (is_def) {
    emit(byte_of(Op::kReturn));
    *def_ = {def_->offset, max_blocks_, calls_, def_->values, def_->reaches, read_sensors_};
    def_ = nullptr;
  } else {
    emit(byte_of(block->type == kTaskBlock ? Op::kEndTask : Op::kEndWhen));
    buffer_[block->code_start - 2] = static_cast<uint8_t>(length_ - block->code_start);
    ended_task_defs_ = static_cast<uint16_t>(ended_task_defs_ | task_defs_);
    task_defs_ = 0;
    is_in_task_ = false;
  }
  const uint8_t blocks = is_def ? uint8_t{0} : max_blocks_;
  const uint8_t calls = is_def ? uint8_t{0} : calls_;
  max_blocks_ = static_cast<uint8_t>(block->read_after);
  calls_ = static_cast<uint8_t>(block->read_after >> 8);
  other_blocks_ = static_cast<uint8_t>(block->known_before + blocks);
  other_calls_ = static_cast<uint8_t>((block->known_before >> 8) + calls);
}

// The token after DEF.
Problem Reader::define(uint8_t token) {
  state_ = kAfterDefName;
  if (token != kNameToken) return Problem::kReserved;
  if (!take_word()) return Problem::kTaken;
  if (stack_ != names_) return Problem::kDef;
  if (defs_ == kDefs) return Problem::kLimit;
  defs_++;
  add_name(kNameDef, sizeof(Def));
  if (problem_ != Problem::kNone) return problem_;
  def_ = reinterpret_cast<Def*>(names_ + 1);
  emit(byte_of(Op::kDef));
  emit(0);
  open_routine(kDefBlock, static_cast<uint8_t>(length_ - 1));
  def_->offset = length_;
  def_->values = variables_ % kVariables;
  def_->reaches = 0;
  return Problem::kNone;
}

// A token after the name of a DEF, or the one after the bracket of a call without values.
Problem Reader::def_head(uint8_t token) {
  if (state_ == kAfterDefName) {
    if (token == '(') {
      brackets_ = 1;
      state_ = kFirstOfDef;
      return Problem::kNone;
    }
    state_ = kInstruction;
    return end_problem(token);
  }
  if (state_ != kNoValues) return def_value_name(token);
  if (token != ')') return Problem::kCount;
  end_arguments();
  return Problem::kNone;
}

// The content of the brackets of a DEF: the names of its values.
Problem Reader::def_value_name(uint8_t token) {
  const uint8_t state = state_;
  if (token == ')' && state != kNextOfDef) {
    brackets_ = 0;
    state_ = kSeparator;
    return Problem::kNone;
  }
  if (token == ';') return Problem::kClose;
  if (state == kAfterOfDef) {
    state_ = kNextOfDef;
    return token == ',' ? Problem::kNone : Problem::kComma;
  }
  if (token != kNameToken) {
    return token == ',' || token == ')' ? Problem::kValue : Problem::kReserved;
  }
  if (!take_word() && name_kind_ != kIsOfOtherDef) return Problem::kTaken;
  if (def_->values >= kMaxValues * kOneValue || variables_ == kVariables) return Problem::kLimit;
  add_name(static_cast<uint8_t>(kNameOfDef | variables_), 0);
  variables_++;
  def_->values = static_cast<uint8_t>(def_->values + kOneValue);
  def_->reaches = static_cast<uint16_t>(1 << (defs_ - 1));
  state_ = kAfterOfDef;
  return Problem::kNone;
}

// TASK or WHEN. Its end is filled in when it comes: a short distance in two bytes.
Problem Reader::begin_task(bool is_when) {
  if (stack_ != names_) return Problem::kDef;
  if (tasks_ == kTasks) return Problem::kLimit;
  tasks_++;
  emit(byte_of(is_when ? Op::kWhen : Op::kTask));
  emit(0);
  emit(0);
  open_routine(is_when ? kWhenBlock : kTaskBlock, 0);
  is_in_task_ = true;
  if (!is_when) return Problem::kNone;
  code_start_ = length_;
  op_ = byte_of(Op::kLook);
  kinds_ = kYesNoKind;
  forever_column_ = 0;
  state_ = kArguments;
  return Problem::kNone;
}

// Notes that what is open reaches these DEFs with values; returns whether no other task does.
bool Reader::reach(uint16_t defs) {
  if (def_ != nullptr) {
    def_->reaches = static_cast<uint16_t>(def_->reaches | defs);
    return true;
  }
  uint16_t other_defs = ended_task_defs_;
  if (is_in_task_) other_defs = static_cast<uint16_t>(other_defs | main_defs_);
  uint16_t* const own_defs = is_in_task_ ? &task_defs_ : &main_defs_;
  *own_defs = static_cast<uint16_t>(*own_defs | defs);
  return (defs & other_defs) == 0;
}

// The part after the name of a DEF: its values, or the end of a call without any.
Problem Reader::begin_call(uint8_t token) {
  const Def* const def = reinterpret_cast<const Def*>(entry_);
  if (def == def_) return at_previous_token(Problem::kUnknownWord);
  const uint8_t calls = static_cast<uint8_t>(def->calls + 1);
  const uint8_t blocks = static_cast<uint8_t>(blocks_ + def->blocks);
  if (calls + other_calls_ > kCalls || blocks + other_blocks_ > kBlocks) {
    return at_previous_token(Problem::kLimit);
  }
  if (calls_ < calls) calls_ = calls;
  if (max_blocks_ < blocks) max_blocks_ = blocks;
  if (!reach(def->reaches)) return at_previous_token(Problem::kOneTask);
  callee_ = static_cast<uint16_t>(end_ - entry_);
  missing_values_ = def->values / kOneValue;
  if (token != '(') {
    if (missing_values_ != 0) return Problem::kOpen;
    if (!ends(token)) return Problem::kSeparator;
    call();
    return Problem::kNone;
  }
  brackets_ = 1;
  state_ = kNoValues;
  if (missing_values_ == 0) return Problem::kNone;
  target_ = def->values % kOneValue;
  kinds_ = missing_values_ > 1 ? kNumberKind * 17 : kNumberKind;
  begin_value();
  return Problem::kNone;
}

// A value of a call has ended.
void Reader::set_call_value() {
  emit_numbered(byte_of(Op::kSetVar), byte_of(Op::kSetVar0), target_);
  target_++;
  missing_values_--;
  kinds_ = missing_values_ > 1 ? kNumberKind * 17 : missing_values_ != 0 ? kNumberKind : uint8_t{0};
}

void Reader::call() {
  const Def* const def = reinterpret_cast<const Def*>(end_ - callee_);
  read_sensors_ |= def->read;
  emit(byte_of(Op::kCall));
  emit(static_cast<uint8_t>(length_ + 1 - def->offset));
}

// CM or DEG after the first value of a move, where the kit says how fast it goes or turns.
Problem Reader::end_distance(bool is_turn) {
  if (command_ > kWordR || kinds_ < 16 || is_turn != (command_ >= kWordL) ||
      !robot_has_speed(is_turn)) {
    return Problem::kReserved;
  }
  is_by_distance_ = true;
  const Problem problem = end_value();
  push(kBase);  // as after FOREVER: the bracket is open
  state_ = kAfterForever;
  return problem == Problem::kNone ? problem : at_previous_token(problem);
}

}  // namespace tiniscript

#endif
