// The offsets in a link at which the interrupt of `boards/avr/uart.cpp` finds the data to send.

#pragma once

#include <stddef.h>

#include "link.h"

namespace tiniscript {

struct Link::Layout {
  static constexpr size_t sent_at() { return offsetof(Link, sent_); }
  static constexpr size_t bytes_left_at() { return offsetof(Link, bytes_left_); }
  static constexpr size_t out_at() { return offsetof(Link, out_); }
};

}  // namespace tiniscript
