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
  if (length_ > kMost) return false;
  bytes_[length_] = 0;
  at_ = bytes_;
  *remote_keys = RemoteKeys();
  skip_blanks();
  if (takes(kPad)) {
    if (!take_way(&remote_keys->pad[0]) || !take_way(&remote_keys->pad[1])) return false;
  } else if (takes(kKey)) {
    for (uint8_t k = 0; k < kRemoteKeys && *at_ == '_'; k++) {
      if (takes(kNames[k])) remote_keys->keys = static_cast<uint8_t>(1 << k);
    }
  } else {
    return false;
  }
  skip_blanks();
  return *at_ == 0;
}

void KeyLine::skip_blanks() {
  while (*at_ == ' ' || *at_ == ';') at_++;
}

// Takes a word that lies in flash, if it comes next.
bool KeyLine::takes(const char* word) {
  const uint8_t* at = at_;
  for (uint8_t letter; (letter = letter_at(word)) != 0; word++, at++) {
    if (*at != letter && (*at & kCapital) != letter) return false;
  }
  at_ = at;
  return true;
}

// Takes a blank and a number from -100 to 100.
bool KeyLine::take_way(int8_t* way) {
  if (*at_++ != ' ') return false;
  const bool is_below = *at_ == '-';
  if (is_below) at_++;
  if (!is_digit(*at_)) return false;
  uint8_t number = 0;
  while (is_digit(*at_)) {
    if (number > kMostPad / 10) return false;
    number = static_cast<uint8_t>(number * 10 + *at_++ - '0');
  }
  if (number > kMostPad) return false;
  *way = static_cast<int8_t>(is_below ? -number : number);
  return true;
}

}  // namespace tiniscript

#endif
