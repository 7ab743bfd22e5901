#include "key_line.h"

#include "../vm/cpu.h"

#ifdef tiniscript_reads_keys

namespace tiniscript {

namespace {

constexpr uint8_t kCapital = 0xdf;  // bits of a letter

const char kPad[] tini_progmem = "PAD";
const char kKey[] tini_progmem = "KEY";
const char kNames[][sizeof "_RIGHT"] tini_progmem = {"_UP", "_DOWN", "_LEFT", "_RIGHT", "_A", "_B"};
static_assert(sizeof kNames / sizeof *kNames == kRemoteKeys, "each key has a name");

uint8_t letter_at(const char* word) {
  return flash_byte(reinterpret_cast<const uint8_t*>(word));
}

bool is_digit(uint8_t byte) { return static_cast<uint8_t>(byte - '0') < 10; }

}  // namespace

bool KeyLine::read(RemoteKeys* remote_keys) {
  if (length_ > kMaxBytes) return false;
  bytes_[length_] = 0;
  cursor_ = bytes_;
  *remote_keys = RemoteKeys();
  skip_blanks();
  if (takes(kPad)) {
    if (!take_axis(&remote_keys->pad[0]) || !take_axis(&remote_keys->pad[1])) return false;
  } else if (takes(kKey)) {
    for (uint8_t k = 0; k < kRemoteKeys && *cursor_ == '_'; k++) {
      if (takes(kNames[k])) remote_keys->keys = static_cast<uint8_t>(1 << k);
    }
  } else {
    return false;
  }
  skip_blanks();
  return *cursor_ == 0;
}

void KeyLine::skip_blanks() {
  while (*cursor_ == ' ' || *cursor_ == ';') cursor_++;
}

// Takes a word that lies in flash, if it comes next.
bool KeyLine::takes(const char* word) {
  const uint8_t* cursor = cursor_;
  for (uint8_t letter; (letter = letter_at(word)) != 0; word++, cursor++) {
    if (*cursor != letter && (*cursor & kCapital) != letter) return false;
  }
  cursor_ = cursor;
  return true;
}

// Takes a blank and a number from -100 to 100.
bool KeyLine::take_axis(int8_t* axis) {
  if (*cursor_++ != ' ') return false;
  const bool is_below = *cursor_ == '-';
  if (is_below) cursor_++;
  if (!is_digit(*cursor_)) return false;
  uint8_t number = 0;
  while (is_digit(*cursor_)) {
    if (number > kMaxPad / 10) return false;
    number = static_cast<uint8_t>(number * 10 + *cursor_++ - '0');
  }
  if (number > kMaxPad) return false;
  *axis = static_cast<int8_t>(is_below ? -number : number);
  return true;
}

}  // namespace tiniscript

#endif
