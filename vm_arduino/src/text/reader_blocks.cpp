// The reader's blocks: headers, arms and ends.

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

uint8_t Reader::awaited_word() const {
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

}  // namespace tiniscript
