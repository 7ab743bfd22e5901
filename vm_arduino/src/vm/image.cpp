#include "image.h"

#include "crc32.h"

namespace tiniscript {

namespace {

// The checksum of any bytes with their own checksum behind them.
constexpr uint32_t kBehindItself = 0x2144df1c;

uint16_t word(const uint8_t* data) { return static_cast<uint16_t>(data[0] | data[1] << 8); }

}  // namespace

Refusal unpack(const uint8_t* data, size_t length, uint16_t kit, Image* image) {
  if (length == 0 || data[0] != 'T' || (length > 1 && data[1] != 'S')) {
    return Refusal::kNotAnImage;
  }
  if (length < kHeaderBytes) return Refusal::kTruncated;
  image->code = data + kHeaderBytes;
  image->code_length = word(data + kCodeLengthAt);
  image->kit = word(data + kKitAt);
  image->start = data[kStartAt];
  if (length - kHeaderBytes < image->code_length) return Refusal::kTruncated;
  if (length - kHeaderBytes > image->code_length) return Refusal::kTrailing;
  uint32_t crc = crc32(0, data, kChecksumAt);
  crc = crc32(crc, image->code, image->code_length);
  if (crc32(crc, data + kChecksumAt, 4) != kBehindItself) return Refusal::kDamaged;
  if (data[kIsaMajorAt] != kIsaMajor || data[kIsaMinorAt] > kIsaMinor) {
    return Refusal::kOtherVersion;
  }
  if (image->start >= kStarts) return Refusal::kUnknownStart;
  if (data[kNeedsAt] != 0) return Refusal::kUnknownNeeds;
  if (image->kit != 0 && image->kit != kit) return Refusal::kOtherKit;
  if (image->start == kStartPing && image->code_length != 0) return Refusal::kPingWithCode;
  return Refusal::kNone;
}

}  // namespace tiniscript
