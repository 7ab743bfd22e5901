// The reader's blocks: headers, arms, ends, the DEFs that a program calls, and its tasks.

#include "reader_parts.h"

namespace tiniscript {

// Opens a block whose first code is the next one. `ends`: an operand that wants its end, or 0.
void Reader::open(uint8_t type, uint8_t ends) {
  if (!kReadsDefs || (type & kBlockType) < kDefBlock) {
    blocks_++;
    const uint8_t beside = kReadsDefs ? beside_blocks_ : uint8_t{0};
    if (static_cast<uint8_t>(blocks_ + beside) > kBlocks) report(Problem::kLimit);
    if (kReadsDefs && deepest_ < blocks_) deepest_ = blocks_;
  }
  if (!has_room(sizeof(Block) - 1)) return;
  stack_ -= sizeof(Block);
  Block* const block = top();
  block->type = type;
  block->ends = ends;
  block->to = length_;
  block->before = read_;
  block->after = static_cast<SensorBits>(~SensorBits{0});
  block->taken = known_;
  if (type != kIfBlock) known_ = read_ = 0;
}

// Emits an instruction that leads to the end of the block that it opens.
void Reader::emit_open(uint8_t op, uint8_t type) {
  emit(op);
  emit(0);
  open(type, static_cast<uint8_t>(length_ - 1));
}

// An ELSE or an ELSEIF: the arm before it ends.
Problem Reader::next_arm() {
  Block* const block = top();
  if (stack_ == names_ || block->type != kIfBlock || block->to == 0) return Problem::kBlock;
  emit(byte_of(Op::kElse));
  link(&block->ends);
  resolve(static_cast<uint8_t>(block->to - 1));
  block->to = 0;
  block->after &= read_;
  read_ = block->before;
  known_ = block->taken;
  first_ = length_;
  return Problem::kNone;
}

// The end of a block.
Problem Reader::close(uint8_t type) {
  Block* const block = top();
  if (stack_ == names_ || (block->type & kBlockType) != type) return Problem::kBlock;
  SensorBits read = block->before;
  const uint8_t to = block->to;
  if (type == kIfBlock) {
    if (to == 0) {
      read = block->after & read_;
    } else {
      resolve(static_cast<uint8_t>(to - 1));
    }
  } else if (kReadsDefs && type >= kDefBlock) {
    close_routine(block);
    blocks_++;  // it is not counted
  } else {
    emit(byte_of(block->type == kLoopBlock ? Op::kNext : Op::kAgain));
    emit(static_cast<uint8_t>(length_ + 1 - to));
  }
  blocks_--;
  read_ = read;
  resolve(block->ends);
  stack_ += sizeof(Block);
  return Problem::kNone;
}

uint8_t Reader::awaited() const {
  if (brackets_ != 0) return ')';
  const uint8_t type = top()->type & kBlockType;
  if (kReadsDefs && type == kTaskBlock) return kWordEndTask;
  if (kReadsDefs && type == kWhenBlock) return kWordEndWhen;
  return static_cast<uint8_t>(kWordEndif + type);
}

// BREAK leaves the innermost loop.
Problem Reader::leave_loop() {
  uint8_t* at = stack_;
  for (;; at += sizeof(Block)) {
    if (at == names_) return Problem::kBreak;
    Block* const block = reinterpret_cast<Block*>(at);
    if (block->type == kIfBlock) continue;
    if (kReadsDefs && (block->type & kBlockType) >= kDefBlock) return Problem::kBreak;
    emit(byte_of(block->type == kLoopBlock ? Op::kBreakLoop : Op::kBreak));
    link(&block->ends);
    return Problem::kNone;
  }
}

#ifdef tiniscript_reads_defs

// Opens a DEF or a task, which stands beside the main task. The depths of that wait in its block.
void Reader::open_routine(uint8_t type, uint8_t ends) {
  open(type, ends);
  if (problem_ != Problem::kNone) return;
  Block* const block = top();
  block->after = static_cast<SensorBits>(deepest_ | calls_ << 8);
  block->taken = static_cast<SensorBits>(beside_blocks_ | beside_calls_ << 8);
  // What a DEF needs counts where it is called.
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
  if (!is_free()) return Problem::kTaken;
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

// What stands in the brackets of a DEF: the names of its values.
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
  if (!is_free() && found_ != kIsGone) return Problem::kTaken;
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

// What follows the name of a DEF: its values, or the end of a call without any.
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

#endif

}  // namespace tiniscript
