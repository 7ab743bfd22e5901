// setup() and loop(): a program that is built in, verified at the start and run.
//
// The button starts and stops it; the light is on while it could start.
// Empty where there is no Arduino: a build for a computer may take all of this folder.

#ifdef ARDUINO

#include "boards/board.h"
#include "robot.h"
#include "vm/image.h"
#include "vm/verify.h"
#include "vm/vm.h"

using namespace tiniscript;

namespace {

constexpr uint8_t kBudget = 32;  // instructions in one turn of loop()

// The paper's obstacle program.
// clang-format off
constexpr uint8_t kProgramBytes = 28;
const uint8_t program[kProgramBytes + kEndBytes] = {
    'T', 'S', 1, 0, 0, 0, 0x1b, 0x23, 14, 0, 0x81, 0x0a, 0x5d, 0x7e,
    0x68,                    // FOREVER
    0x44, 0x0a, 0x50,        // MOVE8_F 10 80
    0xa2, 0x02, 0x0a, 0x04,  // IF_READ8_LT s2 10
    0x58,                    // STOP
    0x47, 0x0a, 0x3c,        // MOVE8_R 10 60
    0x6b, 0x0d,              // AGAIN
};
// clang-format on

Image image;
Machine machine;
int32_t readings[kBoardSensors];
bool is_accepted;
bool is_running;

}  // namespace

void setup() {
  board_begin();
  const bool is_image = unpack(program, kProgramBytes, kBoardKit, &image) == Refusal::kNone;
  is_accepted =
      is_image &&
      verify(image.code, image.code_length, kBoardSensors, kBoardActuators).rule == Rule::kNone;
  board_light(is_accepted);
}

void loop() {
  const uint32_t now_ms = board_now_ms();
  const bool was_running = is_running;
  if (is_running) is_running = machine.tick(now_ms, kBudget) < Status::kDone;
  if (board_pressed()) {
    is_running = is_accepted && !was_running;
    if (is_running) {
      for (int32_t& reading : readings) reading = 0;
      machine.start(image.code, image.code_length, readings, kBoardSensors, now_ms | 1, now_ms);
    } else {
      robot_off();
    }
  }
  if (is_running != was_running) board_light(!is_running);
}

#endif  // ARDUINO
