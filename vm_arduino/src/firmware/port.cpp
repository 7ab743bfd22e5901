// Implements `link/port.h`, except for the identity (`identity.cpp`), transports and
// WiFi (`transports.cpp`) and discs (`guide.cpp`).

#include "../link/port.h"

#include "../link/frames.h"
#include "../vm/image.h"
#include "identity.h"
#include "pace.h"
#include "persistence.h"
#include "program.h"
#include "run.h"
#include "state.h"
#include "trim.h"

namespace tiniscript {

const RobotStatus& port_status() { return robot_status; }

LineErrors port_line_errors() { return board_line_errors(); }

uint16_t port_room() { return kStoredCodeBytes; }

Answer port_prepare_upload(bool is_live) {
  if (!has_booted()) return busy_answer();
  if (is_running()) end_run(State::kIdle);
  forget_start();
  if (is_live) return has_program() || load_program() ? Answer::kOk : Answer::kBusy;
  return give_up_program();
}

bool port_may_prepare_upload(bool is_live) {
  if (!has_booted()) return false;
  return is_live ? has_program() || load_program() : give_up_program() == Answer::kOk;
}

bool port_may_write_ahead() {
  if (!link.is_driving()) return false;
  const bool is_text = kTextIsInProgram && is_image_running(program) && !is_in_memory();
  // No program is loaded: its memory may be that of an upload, which continues despite a frame that
  // is not one.
  return has_booted() && !is_image_running(live) && !is_text && has_program();
}

uint8_t* port_memory(uint16_t length, bool is_live) {
  if (is_live) return length <= kLiveImageBytes ? live : nullptr;
  return length <= kImageBytes ? program : nullptr;
}

void port_forget() {
  hold_stored();
  show_light();
}

void port_take(uint8_t mode, bool is_live) {
  if (is_live) return;
  hold_memory();
  if ((mode & kSave) != 0) keep_program();
  show_light();
}

void port_take_checksum(const uint8_t* image) {
  if (image == program && (!kTextIsInProgram || is_in_memory()))
    robot_status.program = get32(image + kChecksumAt);
}

void port_start(bool is_live) {
  if (is_live || is_in_memory()) begin_run(is_live ? live : program);
}

uint8_t* port_text_memory(uint16_t* room, bool* has_room) {
  static_assert(!kTextIsInProgram || sizeof live - kHeaderBytes <= 255, "a reader moves out of it");
  if (!kTextIsInProgram) {
    if (!link.take_text_memory()) return nullptr;
    *has_room = true;
    *room = kTextRoom;
    return draft;
  }
  *has_room = false;
  *room = sizeof live - kHeaderBytes;
  if (is_image_running(live)) return nullptr;
  link.drop_ahead();
  return live;
}

uint8_t* port_text_room(uint16_t* room) {
  if (!port_may_prepare_upload(false)) return nullptr;
  port_prepare_upload(false);
  port_forget();
  *room = kTextRoom;
  return program;
}

bool port_text_is_separate(bool is_for_button) { return !kTextIsInProgram && !is_for_button; }

void port_take_text(uint8_t* image, bool is_for_button) {
  if (is_for_button) {
    hold_memory();
    show_light();
  } else {
    begin_run(image);
  }
}

Answer port_undo() {
  const Answer answer = port_prepare_upload(false);
  if (answer != Answer::kOk) return answer;
  const bool is_stored = robot_status.slot != kNoSlot;
  if (!hold_previous()) return Answer::kNoPrevious;
  if (is_stored) keep_program();
  show_light();
  return Answer::kOk;
}

void port_end() {
  if (is_running()) end_run(State::kIdle);
}

void port_stop(uint8_t fault) { stop_run(fault); }

void port_release() {
  if (robot_status.state >= State::kStopped) robot_status.state = State::kIdle;
}

uint16_t port_image_length() { return held_bytes(); }

Answer port_image_byte(uint16_t offset, uint8_t* byte) {
  *byte = program[offset];
  const bool is_there =
      is_in_memory() || (has_booted() && store.fetch(Area::kProgram, offset, byte));
  return is_there ? Answer::kOk : busy_answer();
}

Answer port_rename(const uint8_t* name, uint8_t length) {
  if (!has_booted()) return busy_answer();
  if (change_name(name, length)) keep_identity();
  return identity_save_answer();
}

Answer port_tune(const Tuning& new_tuning, bool has_pace) {
  if (!is_sound(new_tuning.trim) || (has_pace && !is_sound(new_tuning.pace)))
    return Answer::kBadValue;
  if (!has_booted()) return busy_answer();
  if (change_tuning(new_tuning, has_pace)) {
    keep_identity();
    if (has_pace) keep_fault();
  }
  return identity_save_answer();
}

}  // namespace tiniscript
