// Finds the bytes that a terminal sends for a cursor key: `ESC [ A`, `ESC O A`, `ESC [ 1 ; 5 C`.

#pragma once

#include <stdint.h>

namespace tiniscript {

class KeySequence {
 public:
  // Takes a byte that does not end a line. Returns whether it belongs to a key, or may.
  bool put(uint8_t byte) {
    const Place previous = place_;
    place_ = kNone;
    if (byte == 0x1b) {
      place_ = kEscape;
    } else if (previous == kEscape) {
      if (byte != '[' && byte != 'O') return false;  // an ESC alone has no effect
      place_ = kInside;
    } else if (previous == kInside) {
      if (byte < ' ' || byte > '~') return false;
      if (byte < '@') place_ = kInside;
    } else {
      return false;
    }
    return true;
  }

  // Whether a key has begun.
  bool is_active() const { return place_ != kNone; }
  void begin() { place_ = kNone; }

 private:
  enum Place : uint8_t { kNone, kEscape, kInside };

  Place place_;
};

}  // namespace tiniscript
