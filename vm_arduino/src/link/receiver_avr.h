// The receiver of an AVR, as its interrupt and its only link find it. `receiver.h` includes this for an AVR.

#pragma once

#include <stddef.h>

namespace tiniscript {

struct Receiver::Layout {
  static constexpr size_t zeros_at() { return offsetof(Receiver, zeros_) + StopSequence::zeros_at(); }
  static constexpr size_t last_ms_at() { return offsetof(Receiver, zeros_) + StopSequence::last_ms_at(); }
};

// A known address takes less flash than a pointer in memory does, and less time.
class OnlyReceiver {
 public:
  void operator=(Receiver*) {}
  Receiver* operator->() const { return *this; }
  operator Receiver*() const {
    extern Receiver receiver;  // firmware/one_line.cpp
    return &receiver;
  }
};

}  // namespace tiniscript
