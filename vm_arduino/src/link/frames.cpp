#include "frames.h"

#include "../vm/image.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

// The CRC-32 of the frame up to `end`. It begins with the major version, so that a peer of another
// one is not misunderstood. HELLO begins with 0: that there is another version must be understood.
one_copy uint32_t checksum(const uint8_t* bytes, uint8_t end) {
  const uint8_t number = static_cast<uint8_t>(bytes[kTypeAt] & ~(kReply | kSealed));
  const bool is_hello = number == static_cast<uint8_t>(Message::kHello);
  return crc32(is_hello ? 0 : kLinkMajor, bytes + kTypeAt, static_cast<uint16_t>(end - kTypeAt));
}

}  // namespace

// Each byte that stands for a zero tells how far it is to the next one.
uint8_t open_frame(uint8_t* bytes, uint8_t length) {
  uint8_t at = bytes[0];
  while (at < length) {
    const uint8_t distance = bytes[at];
    bytes[at] = 0;
    if (distance == 0 || distance > length - at) return 0;
    at = static_cast<uint8_t>(at + distance);
  }
  if (at != length || length < kPayloadAt + kCrcBytes) return 0;
  const uint8_t end = static_cast<uint8_t>(length - kCrcBytes);
  uint32_t crc = checksum(bytes, end);
  for (uint8_t k = end; k < length; k++) {
    if (bytes[k] != static_cast<uint8_t>(crc)) return 0;
    crc >>= 8;
  }
  return end;
}

uint8_t close_frame(uint8_t* bytes, uint8_t end) {
  uint32_t crc = checksum(bytes, end);
  for (uint8_t k = 0; k < kCrcBytes; k++) {
    bytes[end++] = static_cast<uint8_t>(crc);
    crc >>= 8;
  }
  uint8_t zero = 0;  // where the last one was
  bytes[end] = 0;
  for (uint8_t at = 1; at <= end; at++) {
    if (bytes[at] != 0) continue;
    bytes[zero] = static_cast<uint8_t>(at - zero);
    zero = at;
  }
  return static_cast<uint8_t>(end + 1);
}

}  // namespace tiniscript
