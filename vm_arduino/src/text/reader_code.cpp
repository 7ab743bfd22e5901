// The reader's memory: code that grows from the begin of its buffer, and what waits after it.

#include <stddef.h>

#include "reader_parts.h"

namespace tiniscript {

namespace {

constexpr uint8_t kTightRoom = 16;  // more than one byte of text takes

}  // namespace

bool Reader::is_stop_after(uint8_t start) const {
  return length_ == static_cast<uint8_t>(start + 1) && buffer_[start] == byte_of(Op::kStop);
}

bool Reader::wants_room() const { return stack_ - (buffer_ + length_) < kTightRoom + letters_; }

void Reader::move(uint8_t* buffer, uint16_t room) {
  uint8_t* const end = buffer + room;
  const ptrdiff_t shift = end - end_;
  copy_bytes(buffer_, buffer, static_cast<uint8_t>(length_ + letters_));
  copy_bytes(stack_, stack_ + shift, static_cast<uint8_t>(end_ - stack_));
  if (kReadsDefs && def_ != nullptr) {
    def_ = reinterpret_cast<Def*>(reinterpret_cast<uint8_t*>(def_) + shift);
  }
  stack_ += shift;
  names_ += shift;
  end_ = end;
  buffer_ = buffer;
}

// Emits an operand that leads to an end that is not known yet.
void Reader::link(uint8_t* end_operand) {
  emit(*end_operand);
  *end_operand = static_cast<uint8_t>(length_ - 1);
}

// Puts a reading before the code of this instruction, unless it has one.
void Reader::read_first() {
  const uint8_t sensor = number_;
  const SensorBits bit = ask();
  if ((known_sensors_ & bit) != 0) return;
  known_sensors_ |= bit;
  if (sensor < kShorts) {
    insert(static_cast<uint8_t>(byte_of(Op::kRead0) + sensor));
  } else {
    insert(byte_of(Op::kRead));
    insert(sensor);
  }
}

// Puts a byte of a reading where the code of this instruction begins.
void Reader::insert(uint8_t byte) {
  emit(0);
  for (uint8_t offset = code_start_; offset < length_; offset++) {
    const uint8_t following = buffer_[offset];
    buffer_[offset] = byte;
    byte = following;
  }
  code_start_++;
}

}  // namespace tiniscript
