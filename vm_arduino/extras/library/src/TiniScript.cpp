#include "TiniScript.h"

#include <string.h>

#include "vm/cpu.h"
#include "vm/crc32.h"
#include "vm/verify.h"

using namespace tiniscript;

namespace {

TiniPlayer* player = nullptr;

uint32_t add_line(uint32_t crc, const char* line) {
  const uint8_t end = '\n';
  crc = crc32(crc, reinterpret_cast<const uint8_t*>(line), static_cast<uint16_t>(strlen(line)));
  return crc32(crc, &end, 1);
}

// Never 0: that stands for no device.
uint16_t hash_of(uint32_t crc) {
  const uint16_t low = static_cast<uint16_t>(crc);
  return low == 0 ? 0xffff : low;
}

}  // namespace

uint16_t TiniKit::hash(uint16_t device) const { return hash_of(add_line(0, lines[device])); }

uint16_t TiniKit::fingerprint() const {
  uint32_t crc = 0;
  for (uint8_t k = 0; k < sensors + actuators; k++) crc = add_line(crc, lines[k]);
  return hash_of(crc);
}

TiniPlayer::TiniPlayer(TiniRobot* robot, const TiniKit* kit, uint8_t* memory, uint16_t bytes,
                       int32_t* readings)
    : robot_(robot),
      kit_(kit),
      memory_(memory),
      bytes_(bytes),
      readings_(readings),
      machine_(),
      image_(),
      fault_(Fault::kNone),
      is_loaded_(false),
      is_running_(false),
      show_(nullptr) {
  player = this;
}

uint8_t TiniPlayer::load(const uint8_t* image, uint16_t length) {
  stop();
  is_loaded_ = false;
  if (length > bytes_ || bytes_ - length < kEndBytes) return kTooLarge;
  for (uint16_t k = 0; k < length; k++) memory_[k] = flash_byte(image + k);
  return check(length);
}

uint8_t TiniPlayer::check(uint16_t length) {
  is_loaded_ = false;
  const Refusal refusal = unpack(memory_, length, &image_);
  if (refusal != Refusal::kNone) return static_cast<uint8_t>(refusal);
  uint16_t devices = 0;
  const Verdict verdict =
      verify(image_.code, image_.code_length, kit_->sensors, kit_->actuators, &devices,
             image_.needs);
  if (verdict.rule != Rule::kNone) return static_cast<uint8_t>(verdict.rule);
  const Refusal kit = check_devices(image_, devices);
  if (kit != Refusal::kNone) return static_cast<uint8_t>(kit);
  for (uint8_t k = 0; k < kEndBytes; k++) memory_[length + k] = static_cast<uint8_t>(Op::kEnd);
  is_loaded_ = true;
  return 0;
}

void TiniPlayer::start(uint32_t now_ms, uint32_t seed) {
  if (is_loaded_) start_code(image_.code, image_.code_length, now_ms, seed);
}

void TiniPlayer::start_code(const uint8_t* code, uint16_t length, uint32_t now_ms, uint32_t seed) {
  for (uint8_t k = 0; k < kit_->sensors; k++) readings_[k] = 0;
  fault_ = Fault::kNone;
  machine_.start(code, length, readings_, kit_->sensors, seed, now_ms);
  is_running_ = true;
}

void TiniPlayer::tick(uint32_t now_ms) {
  if (!is_running_) return;
  const Status status = machine_.tick(now_ms, kTickBudget);
  if (status != Status::kDone && status != Status::kFault) return;
  is_running_ = false;
  if (status == Status::kFault) fault_ = machine_.fault();
}

void TiniPlayer::stop() {
  if (is_running_) robot_->motors(0, 0);
  is_running_ = false;
}

namespace tiniscript {

void robot_motors(int8_t left, int8_t right) { player->robot()->motors(left, right); }
void robot_off() { player->robot()->motors(0, 0); }
bool robot_read(uint8_t sensor, int32_t* value) { return player->robot()->read(sensor, value); }
void robot_beep(uint16_t hertz, uint32_t duration_ms) { player->robot()->beep(hertz, duration_ms); }
bool robot_show(int32_t value, bool is_yes_no) {
  const TiniPlayer::Show show = player->show();
  return show != nullptr ? show(value, is_yes_no) : player->robot()->show(value, is_yes_no);
}
void robot_set(uint8_t actuator, int32_t value) { player->robot()->set(actuator, value); }
int32_t robot_speed(bool is_turn, uint8_t power) {
  return static_cast<int32_t>(player->robot()->speed(is_turn) * power);
}
uint16_t robot_device_hash(uint16_t device) { return player->kit().hash(device); }

}  // namespace tiniscript
