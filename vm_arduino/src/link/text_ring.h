// The text that waits for the main loop: an interrupt puts bytes in, the main loop takes them out.

#pragma once

#include <stdint.h>

#include "../vm/small.h"
#include "sizes.h"

namespace tiniscript {

class TextRing {
 public:
  bool is_empty() const { return first_ == end_; }

  // Whether whatever a byte makes of a line finds room: it, a mark after it, and the last place.
  bool has_room() const { return static_cast<uint8_t>(first_ - end_ - 1) % kTextBytes > 2; }

  // Puts a byte. False: there is no room. The last place is for `put_last`.
  bool put(uint8_t byte) { return put(byte, 2); }

  // Puts a byte that tells of lost ones. If another line has the last place, that mark covers
  // these, too.
  void put_last(uint8_t byte) { put(byte, 1); }

  bool take(uint8_t* byte) {
    const uint8_t first = first_;
    if (first == end_) return false;
    *byte = bytes_[first];
    asm volatile("" ::: "memory");  // barrier: the byte is read before its place is free
    first_ = static_cast<uint8_t>(first + 1) % kTextBytes;
    return true;
  }

 private:
  tini_noinline bool put(uint8_t byte, uint8_t needed_room) {
    const uint8_t end = end_;
    const uint8_t next_end = static_cast<uint8_t>(end + 1) % kTextBytes;
    if (static_cast<uint8_t>(first_ - next_end) % kTextBytes < needed_room) return false;
    bytes_[end] = byte;
    asm volatile("" ::: "memory");  // barrier: `take` reads the byte after the index
    end_ = next_end;
    return true;
  }

  volatile uint8_t first_;
  volatile uint8_t end_;
  uint8_t bytes_[kTextBytes];
};

}  // namespace tiniscript
