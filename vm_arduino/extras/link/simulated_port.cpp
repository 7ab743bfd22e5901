#include "simulated_port.h"

#include <stdio.h>

#include "../../src/vm/crc32.h"
#include "../../src/vm/image.h"
#include "../../src/vm/vm.h"

using namespace tiniscript;

SimulatedPort port;

namespace {

void say(const char* what, unsigned number = 0) {
  char row[60];
  snprintf(row, sizeof row, what, number);
  port.log += row;
  port.log += "\n";
}

uint16_t length_of(const std::string& image) {
  return image.empty() ? 0 : static_cast<uint16_t>(image.size() - kHeaderBytes);
}

uint32_t checksum_of(const std::string& image) {
  uint32_t found = 0;
  for (uint8_t k = kHeaderBytes; !image.empty() && k-- > kChecksumAt;) {
    found = found << 8 | static_cast<uint8_t>(image[k]);
  }
  return found;
}

void hold(const std::string& image, Saved saved) {
  port.held = image;
  port.condition.program = checksum_of(image);
  port.condition.length = length_of(image);
  port.condition.saved = image.empty() ? Saved::kNothing : saved;
}

std::string text_of(const uint8_t* image) {
  const size_t length = kHeaderBytes + image[kCodeLengthAt] + 256u * image[kCodeLengthAt + 1];
  return std::string(reinterpret_cast<const char*>(image), length);
}

// The image with its checksum.
std::string sealed(std::string image) {
  const uint8_t* const bytes = reinterpret_cast<const uint8_t*>(image.data());
  const uint16_t code_length = static_cast<uint16_t>(image.size() - kHeaderBytes);
  const uint32_t crc = crc32(crc32(0, bytes, kChecksumAt), bytes + kHeaderBytes, code_length);
  image.replace(kChecksumAt, sizeof crc, reinterpret_cast<const char*>(&crc), sizeof crc);
  return image;
}

}  // namespace

namespace tiniscript {

const Equipment& port_equipment() { return port.equipment; }
const Card& port_card() { return port.card; }
const Condition& port_condition() { return port.condition; }
const Trim& port_trim() { return port.trim; }
LineErrors port_line_errors() { return {0, 0}; }
uint16_t port_room() { return port.room; }

Answer port_make_way(bool) {
  if (port.is_busy) return Answer::kBusy;
  if (port.condition.state == State::kRunning) {
    port.condition.state = State::kIdle;
    say("END");
  }
  return Answer::kOk;
}

void port_forget() { hold(port.stored, Saved::kStored); }

uint8_t* port_memory(uint16_t code_length, bool is_live) {
  if (code_length > port.room) return nullptr;
  std::unique_ptr<uint8_t[]>& memory = is_live ? port.live : port.image;
  const size_t size = static_cast<size_t>(kHeaderBytes + code_length + kEndBytes);
  memory.reset(new uint8_t[size]);
  for (size_t k = 0; k < size; k++) memory[k] = 0xa5;  // what was there before
  return memory.get();
}

void port_take(uint8_t mode, bool is_live) {
  const uint8_t* const memory = (is_live ? port.live : port.image).get();
  const std::string image = sealed(text_of(memory));
  for (uint8_t k = 0; k < kEndBytes; k++) {
    if (memory[image.size() + k] != static_cast<uint8_t>(Op::kEnd))
      say("TAKE something without END");
  }
  Image read;
  const bool is_whole = unpack(reinterpret_cast<const uint8_t*>(image.data()), image.size(),
                               port.card.kit, &read) == Refusal::kNone;
  if (!is_whole) say("TAKE something that is no image");
  say(is_live ? "TAKE live %08x" : "TAKE %08x", checksum_of(image));
  if (is_live) return;
  if ((mode & kSave) != 0) port.stored = image;
  hold(image, (mode & kSave) != 0 ? Saved::kStored : Saved::kMemory);
}

void port_seal(const uint8_t* image) {
  if (text_of(image) != sealed(text_of(image))) say("SEAL something else");
}

void port_start(bool is_live) {
  port.condition.state = State::kRunning;
  port.condition.run++;
  say(is_live ? "START live, run %u" : "START run %u", port.condition.run);
}

void port_stop(uint8_t fault) {
  port.condition.state = fault != 0 ? State::kFaulted : State::kStopped;
  if (fault != 0) {
    port.condition.fault = fault;
    port.condition.fault_at = 5;
    port.condition.fault_program = port.condition.program;
  }
  say(fault != 0 ? "FAULT %u" : "STOP", fault);
}

void port_release() {
  if (port.condition.state > State::kRunning) port.condition.state = State::kIdle;
  say("RELEASE");
}

Answer port_image_byte(uint16_t offset, uint8_t* byte) {
  *byte = static_cast<uint8_t>(port.held.at(offset));
  return port.is_busy ? Answer::kBusy : Answer::kOk;
}

Answer port_set_trim(const Trim& trim) {
  if (port.is_busy) return Answer::kBusy;
  if (trim.least > kMostLeast) return Answer::kBadValue;
  port.trim = trim;
  say("TRIM %u", trim.wheels);
  return port.is_saving ? Answer::kSaving : Answer::kOk;
}

Answer port_rename(const uint8_t* name, uint8_t length) {
  if (port.is_busy) return Answer::kBusy;
  for (uint8_t k = 0; k < length; k++) port.equipment.name[k] = name[k];
  port.equipment.name_length = length;
  say("NAME of %u bytes", length);
  return port.is_saving ? Answer::kSaving : Answer::kOk;
}

}  // namespace tiniscript
