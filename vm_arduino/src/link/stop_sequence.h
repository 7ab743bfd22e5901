// The stop sequence: four zeros in a row, whatever is around them.
//
// A second of silence begins a new count. Knows the time of the last byte, and no packet.

#pragma once

#include <stddef.h>
#include <stdint.h>

#include "../vm/small.h"
#include "messages.h"

namespace tiniscript {

class StopSequence {
 public:
  // Counts a byte of 0, and returns whether it completes one. Call it once for each byte, before
  // `keep_and_find_silence`; an AVR's interrupt does it in assembly, at `zeros_at` and `last_ms_at`.
  tini_always_inline bool count_zeros(uint8_t byte, uint16_t now_ms) {
    if (byte != 0) return false;
    const uint8_t zeros = static_cast<uint8_t>(zeros_ + 1);
    zeros_ = zeros;
    if (zeros != kStopZeros || is_quiet(now_ms)) return false;
    last_ms_ = now_ms;
    return true;
  }

  // Keeps what the same byte says. Returns whether a second of silence was before it.
  tini_always_inline bool keep_and_find_silence(uint8_t byte, uint16_t now_ms) {
    const bool was_quiet = is_quiet(now_ms);
    last_ms_ = now_ms;
    if (was_quiet) zeros_ = 1;
    if (byte != 0) zeros_ = 0;
    return was_quiet;
  }

  // Takes the one that the zero which was kept last has completed: four more are another one. False:
  // it has completed none.
  tini_always_inline bool take_whole() {
    if (zeros_ != kStopZeros) return false;
    zeros_ = 0;
    return true;
  }

  uint16_t last_ms() const { return last_ms_; }

  static constexpr size_t zeros_at() { return offsetof(StopSequence, zeros_); }
  static constexpr size_t last_ms_at() { return offsetof(StopSequence, last_ms_); }

 private:
  tini_always_inline bool is_quiet(uint16_t now_ms) const {
    return static_cast<uint16_t>(now_ms - last_ms_) >= kSilenceMs;
  }

  uint8_t zeros_;
  uint16_t last_ms_;
};

}  // namespace tiniscript
