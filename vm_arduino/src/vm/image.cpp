#include "image.h"

#include "crc32.h"

namespace tiniscript {

namespace {

constexpr uint8_t kVersionBytes = kIsaMinorAt + 1;  // these identify an image of any version

uint16_t word(const uint8_t* data) { return static_cast<uint16_t>(data[0] | data[1] << 8); }

}  // namespace

// Checks in the order of `Refusal`, but missing bytes that must be checked are reported first.
Refusal unpack(const uint8_t* data, size_t length, Image* image) {
  if (length == 0 || data[0] != 'T' || (length > 1 && data[1] != 'S')) {
    return Refusal::kNotAnImage;
  }
  if (length < kVersionBytes) return Refusal::kTruncated;
  if (data[kIsaMajorAt] != kIsaMajor || data[kIsaMinorAt] > kIsaMinor) {
    return Refusal::kOtherVersion;
  }
  if (length < kHeaderBytes) return Refusal::kTruncated;
  const uint8_t header_length = data[kHeaderLengthAt];
  image->code = data + header_length;
  image->code_length = word(data + kCodeLengthAt);
  image->devices = word(data + kDevicesAt);
  image->start = data[kStartAt];
  if (header_length < kHeaderBytes || image->code_length > kCodeBytes) return Refusal::kBadHeader;
  const uint16_t whole = static_cast<uint16_t>(header_length + image->code_length);
  if (length < whole) return Refusal::kTruncated;
  if (length > whole) return Refusal::kTrailing;
  uint32_t crc = crc32(0, data, kChecksumAt);
  crc = crc32(crc, data + kBehindChecksum, static_cast<uint16_t>(whole - kBehindChecksum));
  if (crc32(crc, data + kChecksumAt, kChecksumBytes) != kBehindItself) return Refusal::kDamaged;
  if (data[kNeedsAt] != kNeeds) return Refusal::kUnknownNeeds;
  if (image->start >= kStarts) return Refusal::kUnknownStart;
  if (image->start == kStartPing && image->code_length != 0) return Refusal::kPingWithCode;
  return Refusal::kNone;
}

Refusal check_devices(const Image& image, uint16_t devices) {
  if (devices != image.devices) return Refusal::kOtherKit;
  return Refusal::kNone;
}

}  // namespace tiniscript
