// The machine as a WebAssembly module: what `tsc run --machine cpp` runs.
//
// Knows under which names the machine is called from outside, and imports the robot that
// `robot.h` declares. No heap and no library: one image and one machine in memory of fixed size.
// `vm/wasm.py` is the other side.

#include "../../src/robot.h"
#include "../../src/vm/image.h"
#include "../../src/vm/machine.h"
#include "../../src/vm/verify.h"

#define tini_exported(name) extern "C" __attribute__((export_name(name)))
#define tini_imported(name) extern "C" __attribute__((import_module("robot"), import_name(name)))

using namespace tiniscript;

// What the robot is asked; the numbers are in `exchange`.
tini_imported("motors") void host_motors();
tini_imported("off") void host_off();
tini_imported("read") void host_read();
tini_imported("beep") void host_beep();
tini_imported("show") void host_show();
tini_imported("set") void host_set();

namespace {

constexpr uint32_t kRoom = 65536;  // for an image, and for some that are too long

// The numbers of frequent calls. They are exchanged in memory: on the other side, passing some of
// them as arguments takes several times as long as the call.
struct Exchange {
  uint32_t now_ms;  // of a tick,
  uint32_t budget;  // 0 to 65535 instructions; then what is left of it
  uint32_t wake_ms;
  uint32_t status;
  int32_t first;  // what the robot is asked
  int32_t second;
  int32_t answer;  // and what it says, where that is a number,
  uint32_t is_answered;  // or whether it was ready
};

uint8_t room[kRoom + kEndBytes];
Image image;
Verdict verdict;
uint16_t devices;
Machine machine;
int32_t readings[kDevices];
Exchange exchange;
uint32_t speeds[2];        // of the kit, and how fast it turns
uint16_t hashes[2 * 255];  // more than a profile may have

void ask(void (*host)(), int32_t first, int32_t second = 0) {
  exchange.first = first;
  exchange.second = second;
  host();
}

}  // namespace

namespace tiniscript {

void robot_motors(int8_t left, int8_t right) { ask(host_motors, left, right); }

void robot_off() { host_off(); }

bool robot_read(uint8_t sensor, int32_t* value) {
  ask(host_read, sensor);
  if (exchange.is_answered == 0) return false;
  *value = exchange.answer;
  return true;
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  ask(host_beep, hertz, static_cast<int32_t>(duration_ms));
}

bool robot_show(int32_t value, bool is_yes_no) {
  ask(host_show, value, is_yes_no);
  return exchange.is_answered != 0;
}

void robot_set(uint8_t actuator, int32_t value) { ask(host_set, actuator, value); }

int32_t robot_speed(bool is_turn, uint8_t power) { return static_cast<int32_t>(speeds[is_turn] * power); }

uint16_t robot_device_hash(uint16_t device) { return hashes[device]; }

}  // namespace tiniscript

tini_exported("exchange") Exchange* module_exchange() { return &exchange; }

// Where the bytes of an image go.
tini_exported("room") uint8_t* module_room() { return room; }

tini_exported("room_bytes") uint32_t module_room_bytes() { return kRoom; }

// Where the hashes of the kit's devices go: those of sensors, then those of actuators.
tini_exported("hashes") uint16_t* module_hashes() { return hashes; }

// How fast it goes and turns at 100 %, in thousandths.
tini_exported("speeds") uint32_t* module_speeds() { return speeds; }

// Reads the header of the image in the room; returns the number of what refuses it, or 0.
tini_exported("unpack") uint32_t module_unpack(uint32_t length) {
  return static_cast<uint32_t>(unpack(room, length, &image));
}

// Verifies the code of the image; returns the number of the rule that it breaks, or 0.
tini_exported("verify") uint32_t module_verify(uint32_t sensors, uint32_t actuators) {
  verdict = verify(image.code, image.code_length, static_cast<uint8_t>(sensors),
                   static_cast<uint8_t>(actuators), &devices, image.needs);
  return static_cast<uint32_t>(verdict.rule);
}

// Compares the devices that the code uses, which is verified; returns what refuses it, or 0.
tini_exported("compare") uint32_t module_compare() {
  return static_cast<uint32_t>(check_devices(image, devices));
}

// Where the code breaks the rule.
tini_exported("refused_at") uint32_t module_refused_at() { return verdict.offset(); }

// Begins the program of the image, which is verified.
tini_exported("start") void module_start(uint32_t sensors, uint32_t seed, uint32_t now_ms) {
  for (uint8_t k = 0; k < kEndBytes; k++) {
    room[image_length(room) + k] = static_cast<uint8_t>(Op::kEnd);
  }
  for (int32_t& reading : readings) reading = 0;
  machine.start(image.code, image.code_length, readings, static_cast<uint8_t>(sensors), seed,
                now_ms);
}

// Runs instructions at the time of the exchange.
tini_exported("tick") void module_tick() {
  uint32_t budget = exchange.budget;
  Status status;
  bool is_over;
  do {
    const uint8_t slice = budget < 255 ? static_cast<uint8_t>(budget) : 255;
    status = machine.tick(exchange.now_ms, slice);
    budget -= static_cast<uint32_t>(slice - machine.budget_left());
    is_over = status != Status::kRunning || machine.budget_left() != 0;
  } while (budget != 0 && !is_over);
  exchange.budget = budget;
  exchange.wake_ms = machine.wake_ms();
  exchange.status = static_cast<uint32_t>(status);
}

tini_exported("fault") uint32_t module_fault() { return static_cast<uint32_t>(machine.fault()); }

// Where the instruction that runs, or has faulted, begins.
tini_exported("at") uint32_t module_at() { return machine.offset(); }

// Where the SHOW is whose value the host gets.
tini_exported("shown_at") uint32_t module_shown_at() { return machine.shown_at(); }
