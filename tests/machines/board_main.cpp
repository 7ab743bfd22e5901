// A sketch for the tests of `boards/`: a program that is built in, and no firmware around it.
//
// The button starts it when it is released, and stops it as soon as it is pressed. Whoever tests
// puts another program in its place. The light is on while it could start.

#include <Arduino.h>  // declares setup() and loop()

#include "boards/board.h"
#include "boards/kit.h"
#include "boards/motors.h"
#include "firmware/firmware.h"
#include "firmware/remote.h"
#include "firmware/trim.h"
#include "link/port.h"
#include "robot.h"
#include "vm/image.h"
#include "vm/verify.h"
#include "vm/machine.h"

using namespace tiniscript;

namespace {

constexpr uint8_t kBudget = 32;  // instructions in one turn of loop()

// Every robot can run it:  SB|F(1, 60);B(1, 60);BEEP(0.2, 880)
// clang-format off
uint8_t program[kHeaderBytes + kProgramBytes + kEndBytes] = {
    'T', 'S', 2, 0, 1, 15, 0, 0, 10, 0, 0xb1, 0x14, 0x8c, 0x37, 0,
    0x44, 0x64, 0x3c,        // MOVE8_F 100 60
    0x45, 0x64, 0x3c,        // MOVE8_B 100 60
    0x56, 0x14, 0x70, 0x03,  // BEEP8 20 880
};
// clang-format on

Image image;
Machine machine;
int32_t readings[readings_of(kBoardSensors)];
bool is_accepted;
bool is_running;
bool may_start;  // the button went down while nothing ran: its release starts

void start(uint32_t now_ms) {
  board_forget();
  motors_release();
  for (int32_t& reading : readings) reading = 0;
  machine.start(image.code, image.code_length, readings, readings_of(kBoardSensors), now_ms | 1, now_ms);
  is_running = true;
  board_light(false);
}

void stop(bool is_done) {
  motors_stop();
  if (!is_done) board_actuators_off();
  robot_off();
  is_running = false;
  board_light(true);
}

}  // namespace

// What a test does in each turn of loop(), in the file beside.
extern "C" void test_turn() __attribute__((weak));

namespace tiniscript {

// No firmware, so nothing that a watchdog could note.
bool firmware_runs(Place*) { return false; }

bool robot_show(int32_t, bool) { return true; }

// Of the keys every other one is held; PAD_X is 60, PAD_Y 70.
int32_t remote_reading(uint8_t number) { return number < 6 ? number & 1 : number * int32_t{10000}; }

const Tuning& port_tuning() {
  static const Tuning none = {};
  return none;
}

void robot_motors(int8_t left, int8_t right) {
  const Levels levels = trimmed_levels(port_tuning().trim, left, right);
  board_motors(levels.left, levels.right);
}

}  // namespace tiniscript

void setup() {
  board_begin();
  const uint16_t code_length =
      static_cast<uint16_t>(program[kCodeLengthAt] | program[kCodeLengthAt + 1] << 8);
  uint16_t devices;
  is_accepted =
      code_length <= kProgramBytes &&
      unpack(program, kHeaderBytes + code_length, &image) == Refusal::kNone &&
      verify(image.code, code_length, readings_of(kBoardSensors), kBoardActuators, &devices,
             image.needs).rule ==
          Rule::kNone &&
      check_devices(image, devices) == Refusal::kNone;
  board_light(is_accepted);
}

void loop() {
  const uint32_t now_ms = board_now_ms();
  if (board_has_news()) board_tick(now_ms);
  if (test_turn != nullptr) test_turn();
  switch (board_button(now_ms)) {
    case Press::kNothing:
    case Press::kDown:
      break;
    case Press::kPressed:
      may_start = !is_running;
      if (is_running) stop(false);
      break;
    case Press::kReleased:
      if (is_accepted && !is_running && may_start) start(now_ms);
      may_start = false;
      break;
  }
  if (is_running && machine.tick(now_ms, kBudget) >= Status::kDone) {
    const bool is_done = machine.status() == Status::kDone;
    stop(is_done);
    if (is_done) board_finished();
  }
}
