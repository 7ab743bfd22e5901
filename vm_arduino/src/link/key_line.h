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
    if (length_ < kMaxBytes) bytes_[length_] = byte;
    if (length_ <= kMaxBytes) length_++;
  }

  // Whether the line is such a word; returns its meaning.
  bool read(RemoteKeys* remote_keys);

 private:
  static constexpr uint8_t kMaxBytes = 20;  // PAD -100 -100, with a blank and a ; on each side

  bool takes(const char* word);
  bool take_axis(int8_t* axis);
  void skip_blanks();

  const uint8_t* cursor_;
  uint8_t length_;
  uint8_t bytes_[kMaxBytes + 1];
};

}  // namespace tiniscript
