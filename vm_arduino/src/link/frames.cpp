#include "frames.h"

#include "../vm/crc32.h"
#include "../vm/small.h"

namespace tiniscript {

namespace {

// The CRC-32 of any bytes followed by their own CRC-32.
constexpr uint32_t kCrcResidue = 0x2144df1c;

// The CRC-32 of a frame is seeded with 256 times the major version, so that a peer of another version
// rejects the frame. HELLO is seeded with 0, so that both peers can find out that versions differ. (A
// seed below 256 would meet the type's byte: with 2, one damaged bit made a HELLO of a STATUS.)
uint16_t seed_of(uint8_t type) {
  const uint8_t number = static_cast<uint8_t>(type & ~(kReply | kSealed));
  return number == static_cast<uint8_t>(Message::kHello) ? 0 : kLinkMajor << 8;
}

}  // namespace

bool same_bytes(const uint32_t* number, const uint8_t* bytes) {
  const uint8_t* number_bytes = reinterpret_cast<const uint8_t*>(number);
  for (uint8_t k = 0; k < sizeof *number; k++) {
    if (number_bytes[k] != bytes[k]) return false;
  }
  return true;
}

uint16_t get16(const uint8_t* bytes) {
  return static_cast<uint16_t>(bytes[0] | static_cast<uint16_t>(bytes[1]) << 8);
}

tini_noinline uint32_t get32(const uint8_t* bytes) {
  uint32_t number;
  __builtin_memcpy(&number, bytes, sizeof number);
  return number;
}

uint8_t encode_frame(uint8_t* bytes, uint8_t end) {
  const uint32_t crc =
      crc32(seed_of(bytes[kTypeAt]), bytes + kTypeAt, static_cast<uint16_t>(end - kTypeAt));
  __builtin_memcpy(bytes + end, &crc, sizeof crc);
  uint8_t* const end_zero = bytes + end + kCrcBytes;
  *end_zero = 0;
  uint8_t* zero = bytes;  // the last one
  uint8_t* cursor = bytes;
  do {
    if (*++cursor != 0) continue;
    *zero = static_cast<uint8_t>(cursor - zero);
    zero = cursor;
  } while (cursor != end_zero);
  return static_cast<uint8_t>(end + kCrcBytes + 1);
}

void FrameCheck::begin() {
  taken_count_ = 0;
  zero_ = 0;
  next_zero_ = 0;
}

// Each COBS byte gives the distance to the next one. If that leads past the end, the frame is
// damaged.
tini_noinline void FrameCheck::take(const uint8_t* bytes, uint8_t length) {
  for (; taken_count_ < length; taken_count_++) {
    uint8_t byte = bytes[taken_count_];
    if (taken_count_ == zero_) {
      zero_ = static_cast<uint8_t>(zero_ + byte);
      byte = 0;
    }
    if (taken_count_ < kTypeAt) continue;
    const uint32_t crc = taken_count_ == kTypeAt ? seed_of(byte) : crc_;
    crc_ = crc32(crc, &byte, 1);
  }
}

tini_noinline bool FrameCheck::is_whole() const {
  return zero_ == taken_count_ && crc_ == kCrcResidue && taken_count_ >= kPayloadAt + kCrcBytes;
}

tini_noinline uint8_t FrameCheck::decode(uint8_t* bytes) {
  while (next_zero_ != zero_) {
    const uint8_t distance = bytes[next_zero_];
    bytes[next_zero_] = 0;
    next_zero_ = static_cast<uint8_t>(next_zero_ + distance);
  }
  return static_cast<uint8_t>(zero_ - kCrcBytes);
}

uint8_t decode_frame(uint8_t* bytes, uint8_t length) {
  FrameCheck check;
  check.begin();
  check.take(bytes, length);
  return check.is_whole() ? check.decode(bytes) : 0;
}

}  // namespace tiniscript
