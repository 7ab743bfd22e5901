#include "simulated_port.h"

#include <stdio.h>

#include "../../src/robot.h"
#include "../../src/text/kit_words.h"
#include "../../src/vm/image.h"
#include "../../src/vm/machine.h"

using namespace tiniscript;

SimulatedPort port;

namespace {

constexpr uint16_t kScratchBytes = 64;

void say(const char* format, unsigned number = 0) {
  char row[60];
  snprintf(row, sizeof row, format, number);
  port.log += row;
  port.log += "\n";
}

const uint8_t* bytes_of(const std::string& image) {
  return reinterpret_cast<const uint8_t*>(image.data());
}

// The length of its code.
uint16_t length_of(const std::string& image) {
  if (image.empty()) return 0;
  return static_cast<uint16_t>(image.size() - bytes_of(image)[kHeaderLengthAt]);
}

uint32_t checksum_of(const std::string& image) {
  uint32_t checksum = 0;
  for (uint8_t k = kAfterChecksum; !image.empty() && k-- > kChecksumAt;) {
    checksum = checksum << 8 | static_cast<uint8_t>(image[k]);
  }
  return checksum;
}

void hold(const std::string& image, Saved saved) {
  port.held_image = image;
  port.robot_status.program = checksum_of(image);
  port.robot_status.length = length_of(image);
  port.robot_status.saved = image.empty() ? Saved::kNothing : saved;
}

std::string text_of(const uint8_t* image) {
  return std::string(reinterpret_cast<const char*>(image), image_length(image));
}

// The image with its checksum.
std::string with_checksum(std::string image) {
  const uint32_t crc = image_checksum(bytes_of(image), static_cast<uint16_t>(image.size()));
  image.replace(kChecksumAt, sizeof crc, reinterpret_cast<const char*>(&crc), sizeof crc);
  return image;
}

}  // namespace

namespace tiniscript {

const DeviceInfo& port_device_info() { return port.device_info; }
uint8_t port_readings() { return port.sensors; }
uint8_t port_actuators() { return port.actuators; }
Identity& port_identity() { return port.identity; }
const RobotStatus& port_status() { return port.robot_status; }
const Tuning& port_tuning() { return port.tuning; }
LineErrors port_line_errors() { return {0, 0}; }
uint16_t port_room() { return port.room; }

Answer port_prepare_upload(bool is_live) {
  std::unique_ptr<uint8_t[]>& previous_memory = is_live ? port.old_live : port.old_image;
  if (port.is_busy) {
    if (previous_memory != nullptr) previous_memory.swap(is_live ? port.live : port.image);
    previous_memory.reset();
    return Answer::kBusy;
  }
  previous_memory.reset();
  if (port.robot_status.state == State::kRunning) {
    port.robot_status.state = State::kIdle;
    say("END");
  }
  return Answer::kOk;
}

// What may not be lost is not lost by writing ahead: `port_memory` gives other memory each time.
bool port_may_write_ahead() { return !port.is_busy; }

void port_forget() { hold(port.stored_image, Saved::kStored); }

uint8_t* port_memory(uint16_t length, bool is_live) {
  if (length > kHeaderBytes + port.room) return nullptr;
  std::unique_ptr<uint8_t[]>& memory = is_live ? port.live : port.image;
  memory.swap(is_live ? port.old_live : port.old_image);
  const size_t size = static_cast<size_t>(length + kEndBytes);
  memory.reset(new uint8_t[size]);
  for (size_t k = 0; k < size; k++) memory[k] = 0xa5;  // what was there before
  return memory.get();
}

void port_take(uint8_t mode, bool is_live) {
  const uint8_t* const memory = (is_live ? port.live : port.image).get();
  const std::string image = with_checksum(text_of(memory));
  for (uint8_t k = 0; k < kEndBytes; k++) {
    if (memory[image.size() + k] != static_cast<uint8_t>(Op::kEnd))
      say("TAKE something without END");
  }
  Image unpacked;
  const bool is_whole = unpack(bytes_of(image), image.size(), &unpacked) == Refusal::kNone;
  if (!is_whole) say("TAKE something that is no image");
  say(is_live ? "TAKE live %08x" : "TAKE %08x", checksum_of(image));
  if (is_live) return;
  if ((mode & kSave) != 0) {
    port.previous_image = port.stored_image;
    port.stored_image = image;
  }
  hold(image, (mode & kSave) != 0 ? Saved::kStored : Saved::kMemory);
}

void port_take_checksum(const uint8_t* image) {
  if (text_of(image) != with_checksum(text_of(image))) say("SEAL something else");
}

void port_start(bool is_live) {
  port.robot_status.state = State::kRunning;
  port.robot_status.run++;
  port.run_image = is_live ? with_checksum(text_of(port.live.get())) : port.held_image;
  port.offset = 0;
  say(is_live ? "START live, run %u" : "START run %u", port.robot_status.run);
}

// As an Uno: there is room for a whole program only where the one is that the robot holds.
uint8_t* port_text_memory(uint16_t* room, bool* has_room) {
  *has_room = false;
  *room = kScratchBytes;
  port.text.reset(new uint8_t[kHeaderBytes + kScratchBytes]);
  return port.text.get();
}

uint8_t* port_text_room(uint16_t* room) {
  if (!port_may_prepare_upload(false)) return nullptr;
  port_prepare_upload(false);
  port_forget();
  *room = port.room;
  port.whole_text.reset(new uint8_t[static_cast<size_t>(kHeaderBytes + port.room + kEndBytes)]);
  return port.whole_text.get();
}

bool port_may_prepare_upload(bool) { return !port.is_busy; }
bool port_reads_keys() { return false; }

bool port_text_is_separate(bool) { return false; }

void port_take_text(uint8_t* image, bool is_for_button) {
  const std::string image_with_checksum = with_checksum(text_of(image));
  say(is_for_button ? "TEXT %08x for the button" : "TEXT %08x", checksum_of(image_with_checksum));
  if (is_for_button) {
    hold(image_with_checksum, Saved::kMemory);
  } else {
    port_start(false);
    port.run_image = image_with_checksum;
  }
}

Answer port_undo() {
  if (port.is_busy) return Answer::kBusy;
  if (port.previous_image.empty()) return Answer::kNoPrevious;
  port_end();
  port.previous_image.swap(port.stored_image);
  hold(port.stored_image, Saved::kStored);
  say("UNDO %08x", port.robot_status.program);
  return Answer::kOk;
}

void port_end() {
  if (port.robot_status.state == State::kRunning) port_prepare_upload(true);
}

const uint8_t* robot_words() { return port.words.data(); }
uint16_t robot_language() { return 0; }

void port_stop(uint8_t fault) {
  port.robot_status.state = fault != 0 ? State::kFaulted : State::kStopped;
  if (fault != 0) {
    port.robot_status.fault = fault;
    port.robot_status.fault_at = 5;
    port.robot_status.fault_program = port.robot_status.program;
  }
  say(fault != 0 ? "FAULT %u" : "STOP", fault);
}

void port_release() {
  if (port.robot_status.state > State::kRunning) port.robot_status.state = State::kIdle;
  say("RELEASE");
}

uint16_t port_run_at() { return port.offset; }

Answer port_set_breakpoints(const uint8_t* places, uint8_t count) {
  for (uint8_t k = 0; k < count; k++) say("BREAK %u", places[2 * k] | unsigned{places[2 * k + 1]} << 8);
  if (count == 0) say("BREAK nowhere");
  return Answer::kOk;
}

void port_tell_readings(bool is_on) { say("READINGS %u", static_cast<unsigned>(is_on)); }

void port_resume(ResumeHow mode) { say("RESUME %u", static_cast<unsigned>(mode)); }

uint16_t port_shown_at() { return port.offset; }
const uint8_t* port_run_image() { return bytes_of(port.run_image); }

uint16_t port_image_length() { return static_cast<uint16_t>(port.held_image.size()); }

int32_t robot_speed(bool, uint8_t) { return 0; }

uint16_t robot_device_hash(uint16_t device) { return port.hashes.at(device); }

Answer port_image_byte(uint16_t offset, uint8_t* byte) {
  *byte = static_cast<uint8_t>(port.held_image.at(offset));
  return port.is_busy ? Answer::kBusy : Answer::kOk;
}

Answer port_key(uint8_t kind, uint8_t* key) {
  for (uint8_t k = 0; k < kKeyBytes; k++) key[k] = port.keys[kind][k];
  if (port.is_busy) return Answer::kBusy;
  return port.is_saving ? Answer::kSaving : Answer::kOk;
}

Answer port_keep_key(uint8_t kind, const uint8_t* key) {
  bool is_owned = kind == 0 ? false : (port.identity.features & kOwned) != 0;
  for (uint8_t k = 0; k < kKeyBytes; k++) {
    port.keys[kind][k] = key[k];
    if (kind == 0 && key[k] != 0) is_owned = true;
  }
  const int flag = is_owned ? kOwned : 0;
  port.identity.features = static_cast<uint8_t>((port.identity.features & ~kOwned) | flag);
  say("KEY %u", kind);
  return Answer::kSaving;
}

void port_identify() { say("IDENTIFY"); }

Answer port_tune(const Tuning& new_tuning, bool has_pace) {
  if (port.is_busy) return Answer::kBusy;
  if (new_tuning.trim.least > kMaxLeast) return Answer::kBadValue;
  port.tuning.trim = new_tuning.trim;
  if (has_pace) port.tuning.pace = new_tuning.pace;
  say("TRIM %u", new_tuning.trim.wheels);
  return port.is_saving ? Answer::kSaving : Answer::kOk;
}

Answer port_rename(const uint8_t* name, uint8_t length) {
  if (port.is_busy) return Answer::kBusy;
  for (uint8_t k = 0; k < length; k++) port.device_info.name[k] = name[k];
  port.device_info.name_length = length;
  say("NAME of %u bytes", length);
  return port.is_saving ? Answer::kSaving : Answer::kOk;
}

}  // namespace tiniscript
