// The reader's memory: code that grows from the begin of its buffer, and what waits after it.

#include <stddef.h>

#include "reader_avr.h"
#include "reader_parts.h"

namespace tiniscript {

namespace {

constexpr uint8_t kTight = 16;  // more than one byte of text takes

static_assert(static_cast<uint8_t>(Problem::kFull) == tini_problem_full, "");
static_assert(kShorts == tini_shorts, "");
static_assert(byte_of(Op::kPushNum0) == tini_push_num_0, "");
static_assert(byte_of(Op::kPush8) == tini_push_8, "");
static_assert(byte_of(Op::kPush16) == tini_push_16, "");
static_assert(byte_of(Op::kPush32) == tini_push_32, "");
static_assert(byte_of(Op::kPushTenths) == tini_push_tenths, "");
static_assert(byte_of(Op::kPushMilli) == tini_push_milli, "");

}  // namespace

bool Reader::is_stop_after(uint8_t before) const {
  return length_ == static_cast<uint8_t>(before + 1) && buffer_[before] == byte_of(Op::kStop);
}

bool Reader::wants_room() const {
  return stack_ - (buffer_ + length_) < kTight + letters_;
}

void Reader::move(uint8_t* buffer, uint16_t room) {
#ifdef __AVR__
  static_assert(offsetof(Reader, buffer_) == tini_buffer_at, "");
  static_assert(offsetof(Reader, stack_) == tini_waiting_at, "");
  static_assert(offsetof(Reader, length_) == tini_code_length_at, "");
  static_assert(offsetof(Reader, problem_) == tini_problem_at, "");
  static_assert(offsetof(Reader, value_) == tini_value_at, "");
#endif
  uint8_t* const end = buffer + room;
  const ptrdiff_t way = end - end_;
  copy_bytes(buffer_, buffer, static_cast<uint8_t>(length_ + letters_));
  copy_bytes(stack_, stack_ + way, static_cast<uint8_t>(end_ - stack_));
  if (kReadsDefs && def_ != nullptr) {
    def_ = reinterpret_cast<Def*>(reinterpret_cast<uint8_t*>(def_) + way);
  }
  stack_ += way;
  names_ += way;
  end_ = end;
  buffer_ = buffer;
}

#ifndef __AVR__

// Whether a byte fits after the code and `bytes` more.
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

uint8_t Reader::pop() { return *stack_++; }

// Lets the operand at `at`, and those that it names one after the other, lead here.
void Reader::resolve(uint8_t at) {
  while (at != 0) {
    const uint8_t before = buffer_[at];
    buffer_[at] = static_cast<uint8_t>(length_ - at - 1);
    at = before;
  }
}

#endif  // __AVR__

// Emits an operand that leads to an end that is not known yet.
void Reader::link(uint8_t* ends) {
  emit(*ends);
  *ends = static_cast<uint8_t>(length_ - 1);
}

// Puts a reading before the code of this instruction, unless it has one.
void Reader::read_first() {
  const uint8_t sensor = number_;
  const SensorBits bit = ask();
  if ((known_ & bit) != 0) return;
  known_ |= bit;
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
  for (uint8_t at = first_; at < length_; at++) {
    const uint8_t next = buffer_[at];
    buffer_[at] = byte;
    byte = next;
  }
  first_++;
}

#ifndef __AVR__

namespace {

// The number, or 65535 for all that are larger.
tini_noinline uint16_t limited(uint32_t number) {
  return number > 0xffff ? uint16_t{0xffff} : static_cast<uint16_t>(number);
}

}  // namespace

// Emits the shortest instruction that pushes `value_` thousandths, or less them.
void Reader::emit_number(bool is_minus) {
  uint32_t operand = value_;
  uint8_t places = 3;
  while (places != 0 && operand % 10 == 0) {
    operand /= 10;
    places--;
  }
  uint16_t number = limited(operand);
  const uint16_t most = static_cast<uint16_t>(uint16_t{32767} + is_minus);
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
  } else if (places != 0 || number > most) {
    op = byte_of(Op::kPushMilli);
    number = limited(value_);
    if (number > most) {
      op = byte_of(Op::kPush32);
      bytes = 4;
    }
  }
  operand = bytes == 4 ? value_ : number;
  if (is_minus) operand = 0 - operand;
  emit(op);
  for (; bytes != 0; bytes--) {
    emit(static_cast<uint8_t>(operand));
    operand >>= 8;
  }
}

#endif  // __AVR__

}  // namespace tiniscript
