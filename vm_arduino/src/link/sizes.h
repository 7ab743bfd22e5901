// How large the frames of this robot are, and how many of them wait until it has looked at them, which
// HELLO says; and how much its text may miss.
//
// An AVR has memory for one small frame.

#pragma once

#include "../vm/build.h"
#include "messages.h"

namespace tiniscript {

constexpr bool kHasLargeFrames = kRobotSize == RobotSize::kEsp32;
constexpr uint8_t kLargestFrame = kHasLargeFrames ? kLargeFrame : kSmallFrame;
constexpr uint8_t kWindow = kHasLargeFrames ? kLargeWindow : 1;
// The number of text bytes not yet taken, and one more.
constexpr uint16_t kTextBytes = kHasLargeFrames ? 256 : 64;

// Payload bytes of an unsealed frame. In a large frame, a 0 precedes the payload.
constexpr uint8_t kPayloadBytes =
    kLargestFrame - kHeadBytes - kCrcBytes - (kHasLargeFrames ? 1 : 0);

// A frame and its first COBS byte. A packet that begins with another byte than kLargeFirst or less
// is none with more bytes than kSmallPacket.
constexpr uint8_t kPacketBytes = kLargestFrame + 1;
constexpr uint8_t kSmallPacket = kSmallFrame + 1;
constexpr uint8_t kLargeFirst = kHeadBytes + 1;

}  // namespace tiniscript
