#include "frames.h"

#include "../vm/crc32.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

// The CRC-32 of the frame up to `end`. It begins with the major version, so that a peer of another
// one is not misunderstood. HELLO begins with 0: that there is another version must be understood.
tini_noinline uint32_t checksum(const uint8_t* bytes, uint8_t end) {
  const uint8_t number = static_cast<uint8_t>(bytes[kTypeAt] & ~(kReply | kSealed));
  const bool is_hello = number == static_cast<uint8_t>(Message::kHello);
  return crc32(is_hello ? 0 : kLinkMajor, bytes + kTypeAt, static_cast<uint16_t>(end - kTypeAt));
}

}  // namespace

tini_noinline void copy_bytes(const void* from, uint8_t* to, uint8_t length) {
  const uint8_t* bytes = static_cast<const uint8_t*>(from);
  while (length-- != 0) *to++ = *bytes++;
}

tini_noinline bool same_bytes(const uint32_t* number, const uint8_t* bytes) {
  const uint8_t* here = reinterpret_cast<const uint8_t*>(number);
  for (uint8_t k = 0; k < sizeof *number; k++) {
    if (here[k] != bytes[k]) return false;
  }
  return true;
}

tini_noinline uint16_t get16(const uint8_t* bytes) {
  return static_cast<uint16_t>(bytes[0] | static_cast<uint16_t>(bytes[1]) << 8);
}

tini_noinline uint32_t get32(const uint8_t* bytes) {
  uint32_t number;
  __builtin_memcpy(&number, bytes, sizeof number);
  return number;
}

uint8_t encode_frame(uint8_t* bytes, uint8_t end) {
  const uint32_t crc = checksum(bytes, end);
  copy_bytes(&crc, bytes + end, kCrcBytes);
  end = static_cast<uint8_t>(end + kCrcBytes);
  uint8_t zero = 0;  // where the last one was
  bytes[end] = 0;
  for (uint8_t at = 1; at <= end; at++) {
    if (bytes[at] != 0) continue;
    bytes[zero] = static_cast<uint8_t>(at - zero);
    zero = at;
  }
  return static_cast<uint8_t>(end + 1);
}

// Each byte that stands for a zero tells how far it is to the next one.
uint8_t decode_frame(uint8_t* bytes, uint8_t length) {
  uint8_t at = bytes[0];
  while (at < length) {
    const uint8_t distance = bytes[at];
    bytes[at] = 0;
    if (distance == 0 || distance > length - at) return 0;
    at = static_cast<uint8_t>(at + distance);
  }
  if (at != length || length < kPayloadAt + kCrcBytes) return 0;
  const uint8_t end = static_cast<uint8_t>(length - kCrcBytes);
  const uint32_t crc = checksum(bytes, end);
  return same_bytes(&crc, bytes + end) ? end : 0;
}

}  // namespace tiniscript
