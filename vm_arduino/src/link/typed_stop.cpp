#include "typed_stop.h"

#include "../vm/cpu.h"
#include "../vm/find_word.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

// Lines that stop the robot. The second word begins at kStopAt.
// clang-format off
constexpr uint8_t kWords[] tini_progmem = {
    's' | kLastLetter,
    's', 't', 'o', 'p' | kLastLetter,
    's', 't', 'o', 'p', 'n', 'o', 'w' | kLastLetter,
    'a', 'l', 't', 'o' | kLastLetter,
    'p', 'a', 'r', 'a' | kLastLetter,
    'p', 'a', 'r', 'a', 'r' | kLastLetter,
    'p', 'a', 'r', 'e' | kLastLetter,
    'd', 'e', 't', 'e', 'n', 't', 'e' | kLastLetter,
    'h', 'a', 'l', 't' | kLastLetter,
    0};
// clang-format on

constexpr uint8_t kStopAt = 5;  // letters of STOP NOW, without a mark

constexpr int count_words(const uint8_t* letter) {
  return *letter == 0 ? 0 : *letter / kLastLetter + count_words(letter + 1);
}

}  // namespace

// Most bytes of a program are no letters: they are looked at first.
tini_noinline void TypedStop::put(uint8_t byte) {
  if (byte == ' ' || byte == '\t') return;
  const uint8_t urgency = urgency_;
  if (urgency == kComment) return;
  urgency_ = 0;
  const uint8_t count = count_;
  const uint8_t lower_case = byte | 0x20;
  if (static_cast<uint8_t>(lower_case - 'a') >= 26) {
    if (byte == '\b' || byte == 0x7f) {  // deletes a letter, as the reader of text does
      if (count != 0) count_ = static_cast<uint8_t>(count - 1);
      return;
    }
    if (static_cast<uint8_t>(byte - '0') >= 10) {
      if (byte == '/') urgency_ = urgency == kSlash ? kComment : kSlash;
      if (byte != ';') is_loose_ = true;
      return;
    }
  } else if (lower_case == flash_byte(kWords + kStopAt + urgency % 4)) {
    urgency_ = static_cast<uint8_t>(urgency % kUrgent + 1);
  } else if (lower_case == 's') {
    urgency_ = urgency == kTwoS ? kUrgent : urgency % 4 == 1 ? kTwoS : 1;
  }
  add(lower_case);
}

// Adds a letter or a digit of the line. Another S begins a word anew after an S or a STOP.
inline void TypedStop::add(uint8_t lower_case) {
  if (count_ >= kLongest) {
    if (count_ != 255) count_++;
    return;
  }
  if (lower_case == 's' && word() <= kStop) {
    count_ = 0;
    is_loose_ = true;
  }
  word_[count_++] = lower_case;
}

tini_noinline TypedStop::Kind TypedStop::kind() const {
  const uint8_t number = word();
  return number >= kNoWord ? kNone : number <= kStop && !is_loose_ ? kStrict : kLoose;
}

// The number of the word that the line is so far, or kNoWord.
tini_noinline uint8_t TypedStop::word() const {
  static_assert(count_words(kWords) == kNoWord, "");
  const uint8_t length = count_;
  return static_cast<uint8_t>(length - 1) < kLongest ? find_word(kWords, word_, length) : kNoWord;
}

}  // namespace tiniscript
