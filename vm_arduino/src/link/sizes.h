// How large the frames of this robot are, and how many of them wait until it has looked at them, which
// HELLO says; and how much its text may miss.
//
// An AVR has memory for one small frame. tiniscript_like_esp32 is for robots on a computer that have
// the sizes of an ESP32.

#pragma once

#include "messages.h"

#if defined(ARDUINO_ARCH_ESP32) || defined(tiniscript_like_esp32)
#define tiniscript_large_frames
#endif

namespace tiniscript {

#ifdef tiniscript_large_frames
constexpr uint8_t kLargestFrame = kLargeFrame;
constexpr uint8_t kWindow = kLargeWindow;
constexpr uint16_t kTextBytes = 256;
#else
constexpr uint8_t kLargestFrame = kSmallFrame;
constexpr uint8_t kWindow = 1;
constexpr uint8_t kTextBytes = 64;  // of text that nobody has taken yet, and one more
#endif

constexpr bool kHasLargeFrames = kLargestFrame > kSmallFrame;

// Of a frame that is not sealed; a large one has a 0 before it.
constexpr uint8_t kPayloadBytes =
    kLargestFrame - kHeadBytes - kCrcBytes - (kHasLargeFrames ? 1 : 0);

// A frame and its first COBS byte. A packet that begins with another byte than kLargeFirst or less
// is none with more bytes than kSmallPacket.
constexpr uint8_t kPacketBytes = kLargestFrame + 1;
constexpr uint8_t kSmallPacket = kSmallFrame + 1;
constexpr uint8_t kLargeFirst = kHeadBytes + 1;

}  // namespace tiniscript
