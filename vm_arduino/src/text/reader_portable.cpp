// The C++ version of `reader_avr.S`: the reader's memory, its numbers, and its comparison of words.

#include "../vm/find_word.h"
#include "reader_parts.h"

#ifndef __AVR__

namespace tiniscript {

namespace {

// The number, or 65535 for all that are larger.
tini_noinline uint16_t clamp(uint32_t number) {
  return number > 0xffff ? uint16_t{0xffff} : static_cast<uint16_t>(number);
}

}  // namespace

// Whether a byte fits after the code and `bytes` more.
bool Reader::has_room(uint16_t bytes) {
  const uint8_t* const end = buffer_ + length_ + bytes;
  if (end < stack_) return true;
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

uint8_t Reader::pop() { return *stack_++; }

// Lets the operand at `offset`, and those that it names one after the other, lead here.
void Reader::resolve(uint8_t offset) {
  while (offset != 0) {
    const uint8_t next = buffer_[offset];
    buffer_[offset] = static_cast<uint8_t>(length_ - offset - 1);
    offset = next;
  }
}

// Emits the shortest instruction that pushes `value_` thousandths, or less them.
void Reader::emit_number(bool is_minus) {
  uint32_t significand = value_;
  uint8_t places = 3;
  while (places != 0 && significand % 10 == 0) {
    significand /= 10;
    places--;
  }
  uint16_t number = clamp(significand);
  const uint16_t limit = static_cast<uint16_t>(uint16_t{32767} + is_minus);
  uint8_t op = byte_of(Op::kPush16);
  uint8_t bytes = 2;
  if (places == 0 && number <= 12 && is_minus) {
    number = static_cast<uint16_t>(number * 10);
    places = 1;
  }
  if (places == 0 && number <= 255 && !is_minus) {
    op = byte_of(Op::kPush8);
    bytes = 1;
    uint8_t ones = static_cast<uint8_t>(number);
    uint8_t tens = 0;
    while (ones > 10) {
      ones = static_cast<uint8_t>(ones - 10);
      tens++;
    }
    if (tens == 0 || (ones == 10 && tens < 10)) {
      op = static_cast<uint8_t>(byte_of(Op::kPushNum0) + tens + ones);
      bytes = 0;
    }
  } else if (places == 1 && number <= static_cast<uint8_t>(127 + is_minus)) {
    op = byte_of(Op::kPushTenths);
    bytes = 1;
  } else if (places != 0 || number > limit) {
    op = byte_of(Op::kPushMilli);
    number = clamp(value_);
    if (number > limit) {
      op = byte_of(Op::kPush32);
      bytes = 4;
    }
  }
  uint32_t operand = bytes == 4 ? value_ : number;
  if (is_minus) operand = 0 - operand;
  emit(op);
  for (; bytes != 0; bytes--) {
    emit(static_cast<uint8_t>(operand));
    operand >>= 8;
  }
}

// Whether the word is the one at `entry`, which then moves past it.
bool Reader::matches(const uint8_t** entry, bool in_flash) {
  const uint8_t* word = buffer_ + length_;
  const uint8_t* cursor = *entry;
  bool is_same = true;
  uint8_t letter;
  do {
    letter = in_flash ? flash_byte(cursor) : *cursor;
    cursor++;
    if (is_same && letter != *word++) is_same = false;
  } while ((letter & kLastLetter) == 0);
  *entry = cursor;
  return is_same;
}

}  // namespace tiniscript

#endif
