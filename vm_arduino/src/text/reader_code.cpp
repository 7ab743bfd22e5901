// The reader's memory: code that grows from the begin of its buffer, and what waits behind it.

#include "reader_parts.h"

namespace tiniscript {

// Whether a byte fits behind the code and `bytes` more.
bool Reader::has_room(uint16_t bytes) {
  const uint8_t* const behind = buffer_ + length_ + bytes;
  if (behind < stack_) return true;
  report(Problem::kFull);
  return false;
}

void Reader::emit(uint8_t byte) {
  if (length_ == 255) {
    report(Problem::kFull);
  } else if (has_room(0)) {
    buffer_[length_++] = byte;
  }
}

void Reader::emit_numbered(uint8_t op, uint8_t first_short, uint8_t number) {
  if (number < kShorts) {
    emit(static_cast<uint8_t>(first_short + number));
  } else {
    emit(op);
    emit(number);
  }
}

void Reader::push(uint8_t byte) {
  if (has_room(0)) *--stack_ = byte;
}

// Emits an operand that leads to an end that is not known yet.
void Reader::link(uint8_t* ends) {
  emit(*ends);
  *ends = static_cast<uint8_t>(length_ - 1);
}

// Lets the operand at `at`, and those that it names one after the other, lead here.
void Reader::resolve(uint8_t at) {
  while (at != 0) {
    const uint8_t before = buffer_[at];
    buffer_[at] = static_cast<uint8_t>(length_ - at - 1);
    at = before;
  }
}

// Puts a reading before the code of this instruction, unless it has one.
void Reader::read_first(uint8_t sensor) {
  const SensorBits bit = static_cast<SensorBits>(SensorBits{1} << sensor);
  if ((known_ & bit) != 0) return;
  known_ |= bit;
  uint8_t left = length_;
  emit_numbered(byte_of(Op::kRead), byte_of(Op::kRead0), sensor);
  for (; left != length_; left++) {
    uint8_t* const first = buffer_ + first_;
    const uint8_t last = buffer_[length_ - 1];
    __builtin_memmove(first + 1, first, static_cast<size_t>(length_ - 1 - first_));
    *first = last;
  }
  first_ = static_cast<uint8_t>(first_ + (sensor < kShorts ? 1 : 2));
}

void Reader::emit_little_endian(uint32_t value, uint8_t bytes) {
  for (; bytes != 0; bytes--) {
    emit(static_cast<uint8_t>(value));
    value >>= 8;
  }
}

// Emits the shortest instruction that pushes a number: `value` thousandths with the sign of
// `is_minus`, of which `rest` are no whole ones.
void Reader::emit_number(uint32_t value, uint32_t whole, uint16_t rest, bool is_minus) {
  const uint8_t minus = is_minus;
  if (rest == 0 && minus == 0 && whole <= 255) {
    uint8_t tens = 0;
    uint8_t ones = static_cast<uint8_t>(whole);
    if (ones <= 100) {
      while (ones > 10) {
        ones = static_cast<uint8_t>(ones - 10);
        tens++;
      }
      if (tens == 0 || ones == 10) {
        emit(static_cast<uint8_t>(byte_of(Op::kPushNum0) + ones + tens));
        return;
      }
    }
    emit(byte_of(Op::kPush8));
    emit(static_cast<uint8_t>(whole));
    return;
  }
  const uint32_t number = is_minus ? 0 - value : value;
  if (whole <= 12) {
    uint8_t tenths = static_cast<uint8_t>(whole * 10);
    while (rest >= 100) {
      rest = static_cast<uint16_t>(rest - 100);
      tenths++;
    }
    if (rest == 0 && tenths <= 127 + minus) {
      emit(byte_of(Op::kPushTenths));
      emit(is_minus ? static_cast<uint8_t>(-tenths) : tenths);
      return;
    }
    rest = 1;
  }
  uint8_t op = byte_of(Op::kPush32);
  uint8_t bytes = 4;
  uint32_t operand = number;
  if (rest == 0 && whole <= uint32_t{32767} + minus) {
    op = byte_of(Op::kPush16);
    bytes = 2;
    operand = is_minus ? 0 - whole : whole;
  } else if (value <= uint32_t{32767} + minus) {
    op = byte_of(Op::kPushMilli);
    bytes = 2;
  }
  emit(op);
  emit_little_endian(operand, bytes);
}

}  // namespace tiniscript
