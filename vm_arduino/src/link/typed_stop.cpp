#include "typed_stop.h"

#include "../vm/flash.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLast = 0x80;  // marks the last letter of a word
constexpr uint8_t kLetters = 4;  // of STOP

const uint8_t kStop[] tini_progmem = {'s', 't', 'o', 'p'};
const uint8_t kWords[] tini_progmem = {
    's', 't', 'o', 'p', 'n', 'o', 'w' | kLast,
    'a', 'l', 't', 'o' | kLast,
    'p', 'a', 'r', 'a' | kLast,
    'p', 'a', 'r', 'a', 'r' | kLast,
    'p', 'a', 'r', 'e' | kLast,
    'd', 'e', 't', 'e', 'n', 't', 'e' | kLast,
    'h', 'a', 'l', 't' | kLast,
    0};

bool is_letter_or_digit(uint8_t byte) {
  const uint8_t small = byte | 0x20;
  return static_cast<uint8_t>(small - 'a') < 26 || static_cast<uint8_t>(byte - '0') < 10;
}

uint8_t letter_of_stop(uint8_t at) { return flash_byte(kStop + at % kLetters); }

}  // namespace

void TypedStop::begin() {
  count_ = fit_ = hurry_ = slashes_ = 0;
  is_loose_ = false;
}

tini_noinline void TypedStop::put(uint8_t byte) {
  if (byte == '\b' || byte == 0x7f) {  // deletes a letter, as the reader of text does
    if (count_ != 0) count_--;
    if (fit_ > count_) fit_ = count_;
    hurry_ = 0;
    return;
  }
  if (slashes_ == 2 || byte == ' ' || byte == '\t') return;
  slashes_ = byte == '/' ? static_cast<uint8_t>(slashes_ + 1) : 0;
  const uint8_t before = hurry_;
  hurry_ = 0;
  if (!is_letter_or_digit(byte)) {
    if (byte != ';') is_loose_ = true;
    return;
  }
  const uint8_t small = byte | 0x20;
  if (small == letter_of_stop(before)) {
    hurry_ = static_cast<uint8_t>(before % kUrgent + 1);
  } else if (small == 's') {
    hurry_ = before == kTwoS ? kUrgent : before % kLetters == 1 ? kTwoS : 1;
  }
  const uint8_t count = count_;
  if (count < kLongest) word_[count] = small;
  if (count == kMost) {
    fit_ = 0;
    return;
  }
  const uint8_t wanted = count != 0 && word_[1] == 't' ? letter_of_stop(count) : 's';
  if (fit_ == count && small == wanted) fit_ = static_cast<uint8_t>(count + 1);
  count_ = static_cast<uint8_t>(count + 1);
}

bool TypedStop::is_whole() const {
  const uint8_t count = count_;
  if (count == 0) return false;
  if (fit_ != count) return is_word();
  return count == 1 || word_[1] == 's' || count % kLetters == 0;
}

bool TypedStop::is_strict() const {
  const bool is_stop = count_ == 1 || (count_ == kLetters && word_[1] == 't');
  return is_stop && fit_ == count_ && !is_loose_;
}

// Whether the line's letters are one of the words.
bool TypedStop::is_word() const {
  const uint8_t count = count_;
  if (count > kLongest) return false;
  const uint8_t* word = kWords;
  for (;;) {
    bool is_it = true;
    uint8_t letter;
    uint8_t at = 0;
    do {
      letter = flash_byte(word++);
      if (letter == 0) return false;
      if (at >= count || word_[at] != (letter & ~kLast)) is_it = false;
      at++;
    } while ((letter & kLast) == 0);
    if (is_it && at == count) return true;
  }
}

}  // namespace tiniscript
