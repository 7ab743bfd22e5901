// Additional parts of the reader for robots with more flash: DEFs and their calls, tasks, and moves
// by CM and DEG.

#include "reader_parts.h"

#ifdef tiniscript_reads_defs

namespace tiniscript {

// Opens a DEF or a task, which runs in parallel with the main task. The depths of that wait in its
// block.
void Reader::open_routine(uint8_t type, uint8_t ends) {
  open(type, ends);
  if (problem_ != Problem::kNone) return;
  Block* const block = top();
  block->after = static_cast<SensorBits>(deepest_ | calls_ << 8);
  block->taken = static_cast<SensorBits>(beside_blocks_ | beside_calls_ << 8);
  // The needs of a DEF count where it is called.
  const bool is_def = type == kDefBlock;
  beside_blocks_ = is_def ? uint8_t{0} : static_cast<uint8_t>(beside_blocks_ + deepest_);
  beside_calls_ = is_def ? uint8_t{0} : static_cast<uint8_t>(beside_calls_ + calls_);
  deepest_ = calls_ = 0;
}

// A DEF or a task ends.
void Reader::close_routine(Block* block) {
  const bool is_def = block->type == kDefBlock;
  if (is_def) {
    emit(byte_of(Op::kReturn));
    *def_ = {def_->at, deepest_, calls_, def_->values, def_->reaches, read_};
    def_ = nullptr;
  } else {
    emit(byte_of(block->type == kTaskBlock ? Op::kEndTask : Op::kEndWhen));
    buffer_[block->to - 2] = static_cast<uint8_t>(length_ - block->to);
    in_ended_tasks_ = static_cast<uint16_t>(in_ended_tasks_ | in_this_task_);
    in_this_task_ = 0;
    in_task_ = false;
  }
  const uint8_t blocks = is_def ? uint8_t{0} : deepest_;
  const uint8_t calls = is_def ? uint8_t{0} : calls_;
  deepest_ = static_cast<uint8_t>(block->after);
  calls_ = static_cast<uint8_t>(block->after >> 8);
  beside_blocks_ = static_cast<uint8_t>(block->taken + blocks);
  beside_calls_ = static_cast<uint8_t>((block->taken >> 8) + calls);
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
  def_->at = length_;
  def_->values = variables_ % kVariables;
  def_->reaches = 0;
  return Problem::kNone;
}

// A token after the name of a DEF, or the one after the bracket of a call without values.
Problem Reader::head_of_def(uint8_t token) {
  if (state_ == kAfterDefName) {
    if (token == '(') {
      brackets_ = 1;
      state_ = kFirstOfDef;
      return Problem::kNone;
    }
    state_ = kInstruction;
    return no_end(token);
  }
  if (state_ != kNoValues) return name_value_of_def(token);
  if (token != ')') return Problem::kCount;
  end_arguments();
  return Problem::kNone;
}

// The content of the brackets of a DEF: the names of its values.
Problem Reader::name_value_of_def(uint8_t token) {
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
  if (!take_word() && found_ != kIsGone) return Problem::kTaken;
  if (def_->values >= kMostValues * kOneValue || variables_ == kVariables) return Problem::kLimit;
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
  in_task_ = true;
  if (!is_when) return Problem::kNone;
  first_ = length_;
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
  uint16_t others = in_ended_tasks_;
  if (in_task_) others = static_cast<uint16_t>(others | in_main_);
  uint16_t* const mine = in_task_ ? &in_this_task_ : &in_main_;
  *mine = static_cast<uint16_t>(*mine | defs);
  return (defs & others) == 0;
}

// The part after the name of a DEF: its values, or the end of a call without any.
Problem Reader::begin_call(uint8_t token) {
  const Def* const def = reinterpret_cast<const Def*>(entry_);
  if (def == def_) return before(Problem::kUnknownWord);
  const uint8_t calls = static_cast<uint8_t>(def->calls + 1);
  const uint8_t blocks = static_cast<uint8_t>(blocks_ + def->blocks);
  if (calls + beside_calls_ > kCalls || blocks + beside_blocks_ > kBlocks) {
    return before(Problem::kLimit);
  }
  if (calls_ < calls) calls_ = calls;
  if (deepest_ < blocks) deepest_ = blocks;
  if (!reach(def->reaches)) return before(Problem::kOneTask);
  callee_ = static_cast<uint16_t>(end_ - entry_);
  wanted_ = def->values / kOneValue;
  if (token != '(') {
    if (wanted_ != 0) return Problem::kOpen;
    if (!ends(token)) return Problem::kSeparator;
    call();
    return Problem::kNone;
  }
  brackets_ = 1;
  state_ = kNoValues;
  if (wanted_ == 0) return Problem::kNone;
  target_ = def->values % kOneValue;
  kinds_ = wanted_ > 1 ? kNumberKind * 17 : kNumberKind;
  begin_value();
  return Problem::kNone;
}

// A value of a call has ended.
void Reader::give() {
  emit_numbered(byte_of(Op::kSetVar), byte_of(Op::kSetVar0), target_);
  target_++;
  wanted_--;
  kinds_ = wanted_ > 1 ? kNumberKind * 17 : wanted_ != 0 ? kNumberKind : uint8_t{0};
}

void Reader::call() {
  const Def* const def = reinterpret_cast<const Def*>(end_ - callee_);
  read_ |= def->read;
  emit(byte_of(Op::kCall));
  emit(static_cast<uint8_t>(length_ + 1 - def->at));
}

// CM or DEG after the first value of a move, where the kit says how fast it goes or turns.
Problem Reader::end_way(bool is_turn) {
  if (what_ > kWordR || kinds_ < 16 || is_turn != (what_ >= kWordL) || !robot_has_way(is_turn)) {
    return Problem::kReserved;
  }
  is_way_ = true;
  const Problem problem = end_value();
  push(kBase);  // as after FOREVER: the bracket is open
  state_ = kAfterForever;
  return problem == Problem::kNone ? problem : before(problem);
}

}  // namespace tiniscript

#endif
