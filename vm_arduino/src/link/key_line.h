// A line of text that is a word of a remote control: KEY_A, KEY or PAD 30 -20, in any case.
//
// Known before any program is read, so that it needs no memory of one. Knows no robot.

#pragma once

#include <stdint.h>

#include "../vm/build.h"
#include "port.h"

namespace tiniscript {

class KeyLine {
 public:
  void begin() { length_ = 0; }
  bool is_empty() const { return length_ == 0; }

  // Several blanks are kept as one, so that no number of them makes a line too long.
  void put(uint8_t byte) {
    if (byte == '\t') byte = ' ';
    if (byte == ' ' && length_ != 0 && bytes_[length_ - 1] == ' ') return;
    if (length_ < kMost) bytes_[length_] = byte;
    if (length_ <= kMost) length_++;
  }

  // Whether the line is such a word; returns its meaning.
  bool read(RemoteKeys* remote_keys);

 private:
  static constexpr uint8_t kMost = 20;  // PAD -100 -100, with a blank and a ; on each side

  bool takes(const char* word);
  bool take_way(int8_t* way);
  void skip_blanks();

  const uint8_t* at_;
  uint8_t length_;
  uint8_t bytes_[kMost + 1];
};

}  // namespace tiniscript
