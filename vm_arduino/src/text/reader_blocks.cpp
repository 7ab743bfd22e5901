// The reader's blocks: headers, arms and ends.

#include "reader_parts.h"

namespace tiniscript {

// Opens a block whose first code is the next one. `end_operand`: one that wants its end, or 0.
void Reader::open(uint8_t type, uint8_t end_operand) {
  if (!kReadsDefs || (type & kBlockType) < kDefBlock) {
    blocks_++;
    const uint8_t other_blocks = kReadsDefs ? other_blocks_ : uint8_t{0};
    if (static_cast<uint8_t>(blocks_ + other_blocks) > kBlocks) report(Problem::kLimit);
    if (kReadsDefs && max_blocks_ < blocks_) max_blocks_ = blocks_;
  }
  if (!has_room(sizeof(Block) - 1)) return;
  stack_ -= sizeof(Block);
  Block* const block = top();
  block->type = type;
  block->ends = end_operand;
  block->code_start = length_;
  block->read_before = read_sensors_;
  block->read_after = static_cast<SensorBits>(~SensorBits{0});
  block->known_before = known_sensors_;
  if (type != kIfBlock) known_sensors_ = read_sensors_ = 0;
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
  if (stack_ == names_ || block->type != kIfBlock || block->code_start == 0) return Problem::kBlock;
  emit(byte_of(Op::kElse));
  link(&block->ends);
  resolve(static_cast<uint8_t>(block->code_start - 1));
  block->code_start = 0;
  block->read_after &= read_sensors_;
  read_sensors_ = block->read_before;
  known_sensors_ = block->known_before;
  code_start_ = length_;
  return Problem::kNone;
}

// The end of a block.
Problem Reader::close(uint8_t type) {
  Block* const block = top();
  if (stack_ == names_ || (block->type & kBlockType) != type) return Problem::kBlock;
  SensorBits read = block->read_before;
  const uint8_t to = block->code_start;
  if (type == kIfBlock) {
    if (to == 0) {
      read = block->read_after & read_sensors_;
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
  read_sensors_ = read;
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
  uint8_t* cursor = stack_;
  for (;; cursor += sizeof(Block)) {
    if (cursor == names_) return Problem::kBreak;
    Block* const block = reinterpret_cast<Block*>(cursor);
    if (block->type == kIfBlock) continue;
    if (kReadsDefs && (block->type & kBlockType) >= kDefBlock) return Problem::kBreak;
    emit(byte_of(block->type == kLoopBlock ? Op::kBreakLoop : Op::kBreak));
    link(&block->ends);
    return Problem::kNone;
  }
}

}  // namespace tiniscript
