#include "program.h"

#include "../link/frames.h"
#include "../robot.h"
#include "../store/nvm.h"
#include "../vm/flags.h"
#include "../vm/image.h"
#include "state.h"

namespace tiniscript {

uint8_t program[kImageBytes + kEndBytes];
uint8_t live[kLiveImageBytes + kEndBytes];
uint8_t draft[kHeaderBytes + kTextRoom];  // where text is not in `program`

namespace {

Flag<Bit::kWhole> is_whole;            // `program` is the one in `robot_status`
bool has_other;                        // the stored program is of another version
uint8_t more_header;                   // its header, in bytes beyond kHeaderBytes

bool is_other_version(const uint8_t* header) {
  return header[kIsaMajorAt] != kIsaMajor || header[kIsaMinorAt] > kIsaMinor;
}

void hold(const uint8_t* header) {
  more_header = static_cast<uint8_t>(header[kHeaderLengthAt] - kHeaderBytes);
  robot_status.length = get16(header + kCodeLengthAt);
}

}  // namespace

bool is_in_memory() { return is_whole; }

tini_noinline uint16_t held_bytes() {
  return static_cast<uint16_t>(static_cast<uint8_t>(more_header + kHeaderBytes) +
                               robot_status.length);
}

void hold_stored() {
  is_whole = false;
  if (!nvm_is_readable()) {
    robot_status.saved = Saved::kUnreadable;
    robot_status.slot = kNoSlot;
    return;
  }
  uint8_t header[kHeaderBytes];
  for (;;) {
    robot_status.saved = has_other ? Saved::kOtherVersion : Saved::kNothing;
    robot_status.slot = store.current_slot(Area::kProgram);
    if (robot_status.slot == kNoSlot) return;
    if (!store.fetch_first(Area::kProgram, header, kHeaderBytes)) return;
    if (!is_other_version(header)) break;
    has_other = true;
    store.refuse();
  }
  robot_status.saved = Saved::kStored;
  robot_status.program = get32(header + kChecksumAt);
  hold(header);
}

void hold_memory() {
  is_whole = true;
  hold(program);
  robot_status.slot = kNoSlot;
  robot_status.saved = Saved::kMemory;
}

bool hold_previous() {
  const uint8_t slot = robot_status.slot;
  if (slot == kNoSlot) {
    if (store.current_slot(Area::kProgram) == kNoSlot) return false;
    hold_stored();
    return load_program();
  }
  store.refuse();
  hold_stored();
  const bool is_there = load_program() && is_whole;
  store.readmit(slot);
  if (is_there) {
    hold_memory();
  } else {
    hold_stored();
  }
  return is_there;
}

void show_light() { board_light(!is_running() && holds_program()); }

bool has_program() { return is_whole || !holds_program(); }

bool load_program() {
  if (has_program()) return true;
  const uint16_t bytes = held_bytes();
  if (!store.fetch_first(Area::kProgram, program, bytes)) return false;
  for (uint8_t k = 0; k < kEndBytes; k++) program[bytes + k] = static_cast<uint8_t>(Op::kEnd);
  if (admit(program, readings_of(board_sensors()), board_actuators()).refusal == 0) {
    is_whole = true;
  } else {
    // falls back to the program before it, or to none
    store.refuse();
    hold_stored();
  }
  return has_program();
}

}  // namespace tiniscript
