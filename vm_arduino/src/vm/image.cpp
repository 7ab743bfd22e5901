#include "image.h"

#include "crc32.h"
#include "small.h"
#include "verify.h"

namespace tiniscript {

namespace {

constexpr uint8_t kVersionBytes = kIsaMinorAt + 1;  // these identify an image of any version

uint16_t word(const uint8_t* data) { return static_cast<uint16_t>(data[0] | data[1] << 8); }

// Fills `*image` from an image of this version whose lengths are right, and checks the rest of it.
Refusal read(const uint8_t* data, Image* image) {
  image->code = data + data[kHeaderLengthAt];
  image->code_length = word(data + kCodeLengthAt);
  image->devices = word(data + kDevicesAt);
  image->start = data[kStartAt];
  image->needs = data[kNeedsAt];
  uint32_t check;
  __builtin_memcpy(&check, data + kChecksumAt, sizeof check);
  if (image_checksum(data, image_length(data)) != check) return Refusal::kDamaged;
  if ((data[kNeedsAt] & ~kNeeds) != 0) return Refusal::kUnknownNeeds;
  if (image->start >= kStarts) return Refusal::kUnknownStart;
  if (image->start == kStartPing && image->code_length != 0) return Refusal::kPingWithCode;
  return Refusal::kNone;
}

}  // namespace

tini_noinline uint32_t image_checksum(const uint8_t* image, uint16_t length) {
  return crc32(crc32(0, image, kChecksumAt), image + kAfterChecksum,
               static_cast<uint16_t>(length - kAfterChecksum));
}

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
  if (data[kHeaderLengthAt] < kHeaderBytes || word(data + kCodeLengthAt) > kCodeBytes) {
    return Refusal::kBadHeader;
  }
  const uint16_t full_length = image_length(data);
  if (length < full_length) return Refusal::kTruncated;
  if (length > full_length) return Refusal::kTrailing;
  return read(data, image);
}

Refusal check_devices(const Image& image, uint16_t devices) {
  if (devices != image.devices) return Refusal::kOtherKit;
  return Refusal::kNone;
}

tini_noinline Admission admit(const uint8_t* data, uint8_t sensors, uint8_t actuators) {
  Image image;
  const Refusal refusal = read(data, &image);
  if (refusal != Refusal::kNone) return {static_cast<uint8_t>(refusal), 0};
  uint16_t devices;
  const Verdict verdict =
      verify(image.code, image.code_length, sensors, actuators, &devices, image.needs);
  if (!verdict.is_accepted()) return {static_cast<uint8_t>(verdict.rule), verdict.offset()};
  return {static_cast<uint8_t>(check_devices(image, devices)), 0};
}

}  // namespace tiniscript
