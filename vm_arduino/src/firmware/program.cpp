#include "program.h"

#include "../link/frames.h"
#include "../vm/image.h"
#include "../vm/verify.h"
#include "state.h"

namespace tiniscript {

uint8_t program[kHeaderBytes + kStoredCodeBytes + kEndBytes];
uint8_t live[kHeaderBytes + kLiveCodeBytes + kEndBytes];

namespace {

bool is_whole;  // `program` is the one that `condition` names

// Whether the robot may run the image of so many bytes in memory.
bool may_run(uint16_t bytes) {
  Image image;
  return unpack(program, bytes, board.kit, &image) == Refusal::kNone &&
         verify(image.code, image.code_length, board.sensors, board.actuators).rule == Rule::kNone;
}

}  // namespace

bool is_in_memory() { return is_whole; }

void hold_stored() {
  is_whole = false;
  condition.saved = Saved::kNothing;
  condition.slot = store.used(Area::kProgram);
  uint8_t header[kHeaderBytes];
  if (condition.slot == kNoSlot || !store.fetch_first(Area::kProgram, header, kHeaderBytes)) return;
  condition.saved = Saved::kStored;
  condition.program = get32(header + kChecksumAt);
  condition.length = get16(header + kCodeLengthAt);
}

void hold_memory() {
  is_whole = true;
  condition.length = get16(program + kCodeLengthAt);
  condition.slot = kNoSlot;
  condition.saved = Saved::kMemory;
}

bool load_program() {
  if (is_whole || condition.saved == Saved::kNothing) return true;
  const uint16_t bytes = static_cast<uint16_t>(kHeaderBytes + condition.length);
  if (!store.fetch_first(Area::kProgram, program, bytes)) return false;
  for (uint8_t k = 0; k < kEndBytes; k++) program[bytes + k] = static_cast<uint8_t>(Op::kEnd);
  is_whole = may_run(bytes);
  if (!is_whole) {
    // the one before it, or none
    store.refuse();
    hold_stored();
  }
  return is_whole || condition.saved == Saved::kNothing;
}

}  // namespace tiniscript
