// The header of an image: what it says, and what it is refused for.

#include <doctest.h>

#include <functional>

#include "../src/vm/crc32.h"
#include "../src/vm/image.h"
#include "../src/vm/verify.h"
#include "cases.h"

using namespace tiniscript;

namespace {

using Bytes = std::vector<uint8_t>;

constexpr uint16_t kSomeDevices = 0x1234;

// One instruction, with a checksum that fits after `change`.
Bytes image_with(const std::function<void(Bytes*)>& change) {
  Bytes image(kHeaderBytes, 0);
  image[kMagicAt] = 'T';
  image[kMagicAt + 1] = 'S';
  image[kIsaMajorAt] = kIsaMajor;
  image[kIsaMinorAt] = kIsaMinor;
  image[kHeaderLengthAt] = kHeaderBytes;
  image[kDevicesAt] = kSomeDevices & 0xff;
  image[kDevicesAt + 1] = kSomeDevices >> 8;
  image[kCodeLengthAt] = 1;
  image.push_back(static_cast<uint8_t>(Op::kStop));
  change(&image);
  const uint32_t head = crc32(0, image.data(), kChecksumAt);
  const uint16_t rest = static_cast<uint16_t>(image.size() - kBehindChecksum);
  const uint32_t checksum = crc32(head, image.data() + kBehindChecksum, rest);
  for (int k = 0; k < 4; k++) {
    image[static_cast<size_t>(kChecksumAt + k)] = static_cast<uint8_t>(checksum >> (8 * k));
  }
  return image;
}

Refusal refusal(const Bytes& data) {
  Image image;
  return unpack(data.data(), data.size(), &image);
}

void nothing(Bytes*) {}

}  // namespace

TEST_CASE("every image of a program is read") {
  for (const cases::ProgramCase& each : cases::program_cases()) {
    INFO(each.title);
    Image image;
    REQUIRE(unpack(each.image.data(), each.image.size(), &image) == Refusal::kNone);
    CHECK(image.code_length == each.image.size() - kHeaderBytes);
    robot.sensors = each.kit.sensors;
    robot.actuators = each.kit.actuators;
    uint16_t devices = 0;
    const Verdict verdict =
        verify(image.code, image.code_length, static_cast<uint8_t>(robot.sensors.size()),
               static_cast<uint8_t>(robot.actuators.size()), &devices, image.needs);
    CHECK(verdict.rule == Rule::kNone);
    CHECK(devices == image.devices);
  }
}

TEST_CASE("the checksum is the CRC-32 of zlib") {
  const char* const text = "123456789";
  CHECK(crc32(0, reinterpret_cast<const uint8_t*>(text), 9) == 0xcbf43926);
}

TEST_CASE("the fields of an image are where the spec says") {
  const Bytes data = image_with([](Bytes* image) { (*image)[kStartAt] = 1; });
  Image image;
  REQUIRE(unpack(data.data(), data.size(), &image) == Refusal::kNone);
  CHECK(image.start == 1);
  CHECK(image.devices == kSomeDevices);
  CHECK(image.code_length == 1);
  CHECK(image.code == data.data() + kHeaderBytes);
}

TEST_CASE("an image is refused with the first reason that applies") {
  const Bytes good = image_with(nothing);
  CHECK(refusal(good) == Refusal::kNone);
  CHECK(refusal({}) == Refusal::kNotAnImage);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[1] = 's'; })) == Refusal::kNotAnImage);
  for (size_t length = 1; length < good.size(); length++) {
    CAPTURE(length);
    CHECK(refusal(Bytes(good.begin(), good.begin() + static_cast<long>(length))) ==
          Refusal::kTruncated);
  }
  CHECK(refusal(image_with([](Bytes* image) { image->push_back(0); })) == Refusal::kTrailing);
  for (size_t at = kStartAt; at < good.size(); at++) {
    if (at == kHeaderLengthAt || at == kCodeLengthAt || at == kCodeLengthAt + 1) continue;
    CAPTURE(at);
    Bytes damaged = good;
    damaged[at] ^= 1;
    CHECK(refusal(damaged) == Refusal::kDamaged);
  }
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kIsaMajorAt]++; })) ==
        Refusal::kOtherVersion);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kIsaMinorAt]++; })) ==
        Refusal::kOtherVersion);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kStartAt] = kStarts; })) ==
        Refusal::kUnknownStart);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kNeedsAt] = 4; })) ==
        Refusal::kUnknownNeeds);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kHeaderLengthAt]--; })) ==
        Refusal::kBadHeader);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kCodeLengthAt + 1] = 0x80; })) ==
        Refusal::kBadHeader);
  CHECK(refusal(image_with([](Bytes* image) { (*image)[kStartAt] = kStartPing; })) ==
        Refusal::kPingWithCode);
}

TEST_CASE("a longer header is passed over, and covered by the checksum") {
  Bytes data = image_with([](Bytes* image) {
    (*image)[kHeaderLengthAt] = kHeaderBytes + 2;
    image->insert(image->begin() + kHeaderBytes, {1, 2});
  });
  Image image;
  REQUIRE(unpack(data.data(), data.size(), &image) == Refusal::kNone);
  CHECK(image.code == data.data() + kHeaderBytes + 2);
  CHECK(image.code_length == 1);
  data[kHeaderBytes] ^= 1;
  CHECK(refusal(data) == Refusal::kDamaged);
}

TEST_CASE("an image of version 1 is of another version, whatever else is in it") {
  const Bytes old = {'T', 'S', 1, 0, 0, 0, 0, 0, 3, 0, 0x10, 0x16, 0x04, 0xfa, 0x44, 0x32, 0x50};
  CHECK(refusal(old) == Refusal::kOtherVersion);
  CHECK(refusal(Bytes(old.begin(), old.begin() + 4)) == Refusal::kOtherVersion);
}
