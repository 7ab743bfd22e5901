#include "typed_stop.h"

#include "../vm/flash.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLast = 0x80;  // marks the last letter of a word

// What a line is that stops. The second word begins at kStopAt.
// clang-format off
const uint8_t kWords[] tini_progmem = {
    's' | kLast,
    's', 't', 'o', 'p' | kLast,
    's', 't', 'o', 'p', 'n', 'o', 'w' | kLast,
    'a', 'l', 't', 'o' | kLast,
    'p', 'a', 'r', 'a' | kLast,
    'p', 'a', 'r', 'a', 'r' | kLast,
    'p', 'a', 'r', 'e' | kLast,
    'd', 'e', 't', 'e', 'n', 't', 'e' | kLast,
    'h', 'a', 'l', 't' | kLast,
    0};
// clang-format on

constexpr uint8_t kStopAt = 5;  // letters of STOP NOW, without a mark

bool is_letter_or_digit(uint8_t byte) {
  const uint8_t small = byte | 0x20;
  return static_cast<uint8_t>(small - 'a') < 26 || static_cast<uint8_t>(byte - '0') < 10;
}

}  // namespace

tini_noinline void TypedStop::put(uint8_t byte) {
  if (byte == ' ' || byte == '\t') return;
  const uint8_t before = hurry_;
  if (before == kComment) return;
  hurry_ = 0;
  if (byte == '\b' || byte == 0x7f) {  // deletes a letter, as the reader of text does
    if (count_ != 0) count_--;
    return;
  }
  if (!is_letter_or_digit(byte)) {
    if (byte == '/') hurry_ = before == kSlash ? kComment : kSlash;
    if (byte != ';') is_loose_ = true;
    return;
  }
  byte |= 0x20;
  if (byte == flash_byte(kWords + kStopAt + before % 4)) {
    hurry_ = static_cast<uint8_t>(before % kUrgent + 1);
  } else if (byte == 's') {
    hurry_ = before == kTwoS ? kUrgent : before % 4 == 1 ? kTwoS : 1;
  }
  if (byte == 's' && word() <= kStop) {
    count_ = 0;
    is_loose_ = true;
  }
  const uint8_t count = count_;
  if (count < kLongest) word_[count] = byte;
  if (count != 255) count_ = static_cast<uint8_t>(count + 1);
}

// The number of the word that the line is so far.
tini_noinline uint8_t TypedStop::word() const {
  const uint8_t* letter = kWords;
  for (uint8_t number = 0; flash_byte(letter) != 0; number++) {
    const uint8_t* mine = word_;
    uint8_t other = 0;  // bits in which they differ
    do {
      other |= static_cast<uint8_t>(flash_byte(letter) ^ *mine++);
    } while ((flash_byte(letter++) & kLast) == 0);
    if (other == kLast && mine == word_ + count_) return number;
  }
  return kNoWord;
}

}  // namespace tiniscript
