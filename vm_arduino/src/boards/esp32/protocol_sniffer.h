// Decides by the first bytes of a connection whether its client may be meant for a robot, as
// `virtual/protocol_sniffer.py` does: bytes that begin like HTTP, TLS or STUN may be a web page's.

#pragma once

#include <stddef.h>
#include <stdint.h>

namespace tiniscript {

enum class Protocol : uint8_t { kUnknownYet, kForRobot, kOther };

constexpr size_t kFirstBytes = 512;  // of a first line that is still open, at most

Protocol sniff_protocol(const uint8_t* bytes, size_t length);

}  // namespace tiniscript
