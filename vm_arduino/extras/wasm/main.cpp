// The machine as a WebAssembly module: what `tsc run --machine cpp` runs.
//
// Knows under which names the machine is called from outside, and imports the robot that
// `robot.h` declares. No heap and no library: one image and one machine in memory of fixed size.
// `vm/wasm.py` is the other side.

#include "../../src/robot.h"
#include "../../src/vm/image.h"
#include "../../src/vm/verify.h"
#include "../../src/vm/vm.h"

#define tini_exported(name) extern "C" __attribute__((export_name(name)))
#define tini_imported(name) extern "C" __attribute__((import_module("robot"), import_name(name)))

using namespace tiniscript;

tini_imported("motors") void host_motors(int32_t left, int32_t right);
tini_imported("off") void host_off();
tini_imported("read") int64_t host_read(uint32_t sensor);
tini_imported("beep") void host_beep(uint32_t hertz, uint32_t duration_ms);
tini_imported("show") int32_t host_show(int32_t value, int32_t is_yes_no);
tini_imported("set") void host_set(uint32_t actuator, int32_t value);

namespace {

constexpr uint32_t kRoom = 65536;  // for an image, and for some that are too long
constexpr int64_t kNotThere = static_cast<int64_t>(1) << 32;  // what is no reading

uint8_t room[kRoom + kEndBytes];
Image image;
Verdict verdict;
Machine machine;
int32_t readings[kDevices];

}  // namespace

namespace tiniscript {

void robot_motors(int8_t left, int8_t right) { host_motors(left, right); }

void robot_off() { host_off(); }

bool robot_read(uint8_t sensor, int32_t* value) {
  const int64_t found = host_read(sensor);
  if (found == kNotThere) return false;
  *value = static_cast<int32_t>(found);
  return true;
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) { host_beep(hertz, duration_ms); }

bool robot_show(int32_t value, bool is_yes_no) { return host_show(value, is_yes_no) != 0; }

void robot_set(uint8_t actuator, int32_t value) { host_set(actuator, value); }

}  // namespace tiniscript

// Where the bytes of an image go.
tini_exported("room") uint8_t* module_room() { return room; }

tini_exported("room_bytes") uint32_t module_room_bytes() { return kRoom; }

// Reads the header of the image in the room; returns the number of what refuses it, or 0.
tini_exported("unpack") uint32_t module_unpack(uint32_t length, uint32_t kit) {
  return static_cast<uint32_t>(unpack(room, length, static_cast<uint16_t>(kit), &image));
}

// Verifies the code of the image; returns the number of the rule that it breaks, or 0.
tini_exported("verify") uint32_t module_verify(uint32_t sensors, uint32_t actuators) {
  verdict = verify(image.code, image.code_length, static_cast<uint8_t>(sensors),
                   static_cast<uint8_t>(actuators));
  return static_cast<uint32_t>(verdict.rule);
}

// Where the code breaks the rule.
tini_exported("refused_at") uint32_t module_refused_at() { return verdict.offset; }

// Begins the program of the image, which is verified.
tini_exported("start") void module_start(uint32_t sensors, uint32_t seed, uint32_t now_ms) {
  for (uint8_t k = 0; k < kEndBytes; k++) {
    room[kHeaderBytes + image.code_length + k] = static_cast<uint8_t>(Op::kEnd);
  }
  for (int32_t& reading : readings) reading = 0;
  machine.start(image.code, image.code_length, readings, static_cast<uint8_t>(sensors), seed,
                now_ms);
}

// Runs at most `budget` (0 to 65535) instructions. From the lowest bit: 32 of `wake_ms`, 16 of
// how much of the budget is left, 8 of the status.
tini_exported("tick") uint64_t module_tick(uint32_t now_ms, uint32_t budget) {
  Status status;
  bool is_over;
  do {
    const uint8_t slice = budget < 255 ? static_cast<uint8_t>(budget) : 255;
    status = machine.tick(now_ms, slice);
    budget -= static_cast<uint32_t>(slice - machine.left());
    is_over = status != Status::kRunning || machine.left() != 0;
  } while (budget != 0 && !is_over);
  return machine.wake_ms() | static_cast<uint64_t>(budget) << 32 |
         static_cast<uint64_t>(status) << 48;
}

tini_exported("fault") uint32_t module_fault() { return static_cast<uint32_t>(machine.fault()); }

// Where the instruction that runs, or has faulted, begins.
tini_exported("at") uint32_t module_at() { return machine.at(); }
