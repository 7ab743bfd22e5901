// The reader's blocks: headers, arms, ends, and the DEFs that a program calls.

#include "reader_parts.h"

namespace tiniscript {

// Opens a block whose first code is the next one. `ends`: an operand that wants its end, or 0.
void Reader::open(uint8_t type, uint8_t ends) {
  if (!kReadsDefs || type != kDefBlock) {
    blocks_++;
    if (blocks_ > kBlocks) report(Problem::kLimit);
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
  } else if (kReadsDefs && type == kDefBlock) {
    emit(byte_of(Op::kReturn));
    def_->blocks = deepest_;
    def_->calls = calls_;
    def_->read = read_;
    def_ = nullptr;
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
  return static_cast<uint8_t>(kWordEndif + (top()->type & kBlockType));
}

// BREAK leaves the innermost loop.
Problem Reader::leave_loop() {
  uint8_t* at = stack_;
  for (;; at += sizeof(Block)) {
    if (at == names_) return Problem::kBreak;
    Block* const block = reinterpret_cast<Block*>(at);
    if (block->type == kIfBlock) continue;
    if (kReadsDefs && block->type == kDefBlock) return Problem::kBreak;
    emit(byte_of(block->type == kLoopBlock ? Op::kBreakLoop : Op::kBreak));
    link(&block->ends);
    return Problem::kNone;
  }
}

// The token behind DEF.
Problem Reader::define(uint8_t token) {
  state_ = kSeparator;
  if (token != kNameToken) return Problem::kReserved;
  if (found_ != 0) return Problem::kTaken;
  if (stack_ != names_) return Problem::kDef;
  if (defs_ == kDefs) return Problem::kLimit;
  defs_++;
  add_name(kNameDef, sizeof(Def));
  if (problem_ != Problem::kNone) return problem_;
  def_ = reinterpret_cast<Def*>(names_ + 1);
  deepest_ = 0;
  calls_ = 0;
  emit_open(byte_of(Op::kDef), kDefBlock);
  def_->at = length_;
  return Problem::kNone;
}

// The name of a DEF alone calls it.
Problem Reader::call() {
  const Def* const def = reinterpret_cast<const Def*>(entry_);
  if (def == def_) return Problem::kUnknownWord;
  const uint8_t calls = static_cast<uint8_t>(def->calls + 1);
  const uint8_t blocks = static_cast<uint8_t>(blocks_ + def->blocks);
  if (calls > kCalls || blocks > kBlocks) return Problem::kLimit;
  if (calls_ < calls) calls_ = calls;
  if (deepest_ < blocks) deepest_ = blocks;
  read_ |= def->read;
  emit(byte_of(Op::kCall));
  emit(static_cast<uint8_t>(length_ + 1 - def->at));
  return Problem::kNone;
}

}  // namespace tiniscript
