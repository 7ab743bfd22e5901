// Decides by the first bytes of a connection whether its client may be meant for a robot, as
// `virtual/first_bytes.py` does: what begins like HTTP, TLS or STUN may be a web page's.

#ifndef TINISCRIPT_ESP32_FIRST_BYTES_H_
#define TINISCRIPT_ESP32_FIRST_BYTES_H_

#include <stddef.h>
#include <stdint.h>

namespace tiniscript {

enum class Guest : uint8_t { kUnknownYet, kForRobot, kOther };

constexpr size_t kFirstBytes = 512;  // of a first line that is still open, at most

Guest guest_of(const uint8_t* bytes, size_t length);

}  // namespace tiniscript

#endif  // TINISCRIPT_ESP32_FIRST_BYTES_H_
