#include "identify.h"

#include "../robot.h"
#include "program.h"
#include "state.h"

namespace tiniscript {

namespace {

constexpr uint8_t kSteps = 13;  // the light changes in each but the last, which shows the message
constexpr uint16_t kStepMs = 250;
constexpr uint8_t kNoteMs = 200;
constexpr uint8_t kNotes = 3;

// Notes are multiples of 131 Hz, from the 4th to the 11th: three bits of the id each.
constexpr uint16_t kBaseHertz = 131;
constexpr uint8_t kLowest = 4;
constexpr uint8_t kNoteBits = 3;

uint8_t steps;  // left
uint16_t step_ms;

}  // namespace

void port_identify() {
  steps = kSteps;
  step_ms = static_cast<uint16_t>(now_ms - kStepMs);
}

void tick_identify() {
  if (steps == 0 || static_cast<uint16_t>(now_ms - step_ms) < kStepMs) return;
  step_ms = static_cast<uint16_t>(now_ms);
  const uint8_t step = static_cast<uint8_t>(kSteps - steps--);
  if (steps == 0) return show_light();
  board_light(step % 2 == 0);
  if (step >= kNotes || is_running()) return;
  const uint16_t notes = static_cast<uint16_t>(port_identity().id >> step * kNoteBits);
  robot_beep(static_cast<uint16_t>((notes % 8 + kLowest) * kBaseHertz), kNoteMs);
}

}  // namespace tiniscript
