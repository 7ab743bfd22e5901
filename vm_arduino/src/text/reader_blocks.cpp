// The reader's blocks: headers, arms, ends, and the DEFs that a program calls.

#include "reader_parts.h"

namespace tiniscript {

// Opens a block whose first code is the next one. `ends`: an operand that wants its end, or 0.
void Reader::open(uint8_t type, uint8_t ends) {
  if (type != kWordEndDef) {
    blocks_++;
    if (blocks_ > kBlocks) report(Problem::kLimit);
    if (deepest_ < blocks_) deepest_ = blocks_;
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
  if (type != kWordEndif) known_ = read_ = 0;
}

// An ELSE or an ELSEIF: the arm before it ends.
void Reader::next_arm() {
  Block* const block = top();
  if (stack_ == names_ || block->type != kWordEndif || block->to == 0) {
    report(Problem::kBlock);
    return;
  }
  emit(byte_of(Op::kElse));
  link(&block->ends);
  resolve(static_cast<uint8_t>(block->to - 1));
  block->to = 0;
  block->after &= read_;
  read_ = block->before;
  known_ = block->taken;
  first_ = length_;
}

// The end of a block; `word` is the first of its spellings.
void Reader::close(uint8_t word) {
  Block* const block = top();
  const bool is_loop = word == kWordEndLoop || word == kWordEndWhile;
  uint8_t type = kWordEndif;
  if (stack_ != names_) type = block->type;
  if (stack_ == names_ || (type != word && (type != kForeverLoop || word != kWordEndLoop))) {
    report(Problem::kBlock);
    return;
  }
  if (is_loop) {
    emit(byte_of(type == kWordEndLoop ? Op::kNext : Op::kAgain));
    emit(static_cast<uint8_t>(length_ + 1 - block->to));
  } else if (word == kWordEndDef) {
    emit(byte_of(Op::kReturn));
    def_->blocks = deepest_;
    def_->calls = calls_;
    def_->read = read_;
    def_ = nullptr;
  }
  resolve(block->ends);
  if (word == kWordEndif) {
    if (block->to != 0) {  // the arm that is missing does nothing
      resolve(static_cast<uint8_t>(block->to - 1));
      read_ = static_cast<SensorBits>(read_ & block->before);
    }
    read_ = static_cast<SensorBits>(read_ & block->after);
  } else {
    read_ = block->before;
  }
  if (word != kWordEndDef) blocks_--;
  stack_ += sizeof(Block);
}

// BREAK leaves the innermost loop.
void Reader::leave_loop() {
  uint8_t* at = stack_;
  for (;; at += sizeof(Block)) {
    Block* const block = reinterpret_cast<Block*>(at);
    if (at == names_ || block->type == kWordEndDef) {
      report(Problem::kBreak);
      return;
    }
    if (block->type == kWordEndif) continue;
    emit(byte_of(block->type == kWordEndLoop ? Op::kBreakLoop : Op::kBreak));
    link(&block->ends);
    return;
  }
}

// The token behind DEF.
void Reader::define(uint8_t token) {
  state_ = kSeparator;
  if (token != kNameToken || found_ != 0) {
    report(token == kNameToken ? Problem::kTaken : Problem::kReserved);
    return;
  }
  if (stack_ != names_) report(Problem::kDef);
  if (defs_ == kDefs) report(Problem::kLimit);
  defs_++;
  add_name(kNameDef, sizeof(Def));
  if (problem_ != Problem::kNone) return;
  def_ = reinterpret_cast<Def*>(names_ + 1);
  deepest_ = 0;
  calls_ = 0;
  emit(byte_of(Op::kDef));
  emit(0);
  def_->at = length_;
  open(kWordEndDef, static_cast<uint8_t>(length_ - 1));
}

// The name of a DEF alone calls it.
void Reader::call() {
  const Def* const def = reinterpret_cast<const Def*>(entry_);
  if (def == def_) report(Problem::kUnknownWord);
  const uint8_t calls = static_cast<uint8_t>(def->calls + 1);
  const uint8_t blocks = static_cast<uint8_t>(blocks_ + def->blocks);
  if (calls > kCalls || blocks > kBlocks) report(Problem::kLimit);
  if (calls_ < calls) calls_ = calls;
  if (deepest_ < blocks) deepest_ = blocks;
  read_ |= def->read;
  emit(byte_of(Op::kCall));
  emit(static_cast<uint8_t>(length_ + 1 - def->at));
}

}  // namespace tiniscript
