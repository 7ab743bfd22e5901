// The reader of images, the verifier and the machine: what is accepted runs without BAD_CODE.
//
// An input is what the kit has (sensors, actuators), how the image is taken, and its bytes. An odd
// third byte makes header and checksum right first, or the fuzzer would never get past them.

#include <string.h>

#include <vector>

#include "../../src/robot.h"
#include "../../src/vm/image.h"
#include "../../src/vm/machine.h"
#include "../../src/vm/verify.h"
#include "input.h"

using namespace tiniscript;

namespace {

constexpr uint16_t kTicks = 60;
constexpr uint8_t kBudget = 20;  // instructions
constexpr size_t kMaxBytes = 600;

bool is_on;        // a motor
bool is_refusing;  // every second question is answered "not yet"

bool is_ready() {
  is_refusing = !is_refusing;
  return is_refusing;
}

void make_valid(std::vector<uint8_t>* image) {
  uint8_t* const bytes = image->data();
  const size_t code = image->size() - kHeaderBytes;
  bytes[kMagicAt] = 'T';
  bytes[kMagicAt + 1] = 'S';
  bytes[kIsaMajorAt] = kIsaMajor;
  bytes[kIsaMinorAt] = kIsaMinor;
  bytes[kHeaderLengthAt] = kHeaderBytes;
  bytes[kStartAt] &= 1;
  bytes[kNeedsAt] = kNeeds;
  bytes[kCodeLengthAt] = static_cast<uint8_t>(code);
  bytes[kCodeLengthAt + 1] = static_cast<uint8_t>(code >> 8);
  const uint32_t check = image_checksum(bytes, static_cast<uint16_t>(image->size()));
  memcpy(bytes + kChecksumAt, &check, sizeof check);
}

}  // namespace

namespace tiniscript {

void robot_motors(int8_t left, int8_t right) {
  must(left >= -100 && left <= 100 && right >= -100 && right <= 100);
  is_on = (left | right) != 0;
}
void robot_off() { is_on = false; }
bool robot_read(uint8_t sensor, int32_t* value) {
  *value = sensor * 1000 - 3000;
  return is_ready();
}
void robot_beep(uint16_t hertz, uint32_t) { must(hertz >= 31 && hertz <= 20000); }
bool robot_show(int32_t, bool) { return is_ready(); }
void robot_set(uint8_t, int32_t) {}
int32_t robot_speed(bool is_turn, uint8_t power) { return is_turn ? 360000 * power : 0; }
uint16_t robot_device_hash(uint16_t device) { return static_cast<uint16_t>(device * 0x1235); }

}  // namespace tiniscript

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Input input(data, size);
  const uint8_t sensors = input.u8() % 16;
  const uint8_t actuators = input.u8() % 8;
  const uint8_t flags = input.u8();
  std::vector<uint8_t> image;
  while (input.has_more() && image.size() < kMaxBytes) image.push_back(input.u8());
  if ((flags & 1) != 0) {
    if (image.size() < kHeaderBytes) return -1;
    make_valid(&image);
  }
  const uint16_t length = static_cast<uint16_t>(image.size());
  image.resize(length + kEndBytes);                                   // the machine's own: END
  std::vector<uint8_t> exact(image.begin(), image.begin() + length);  // a sanitizer sees its end
  uint16_t devices;
  Image unpacked;
  if (unpack(exact.data(), length, &unpacked) != Refusal::kNone) return 0;
  if (verify(unpacked.code, unpacked.code_length, sensors, actuators, &devices, unpacked.needs)
          .rule != Rule::kNone) {
    return 0;
  }
  const bool is_for_kit = check_devices(unpacked, devices) == Refusal::kNone;
  const Admission admission = admit(exact.data(), sensors, actuators);
  must((admission.refusal == 0) == is_for_kit);

  std::vector<uint8_t> code(unpacked.code, unpacked.code + unpacked.code_length);
  code.resize(code.size() + kEndBytes, static_cast<uint8_t>(Op::kEnd));
  Machine machine;
  std::vector<int32_t> readings(sensors);
  uint32_t now_ms = flags * 0x01000000U;
  machine.start(code.data(), unpacked.code_length, readings.data(), sensors, flags | 1U, now_ms);
  for (uint16_t k = 0; k < kTicks; k++) {
    const Status status = machine.tick(now_ms, kBudget);
    if (status == Status::kWaiting) now_ms = machine.wake_ms();
    if (status < Status::kDone) continue;
    must(!is_on);
    break;
  }
  must(machine.fault() != Fault::kBadCode);
  return 0;
}
