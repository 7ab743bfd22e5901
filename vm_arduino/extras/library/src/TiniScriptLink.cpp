#include "TiniScriptLink.h"

#include <string.h>

#include "text/kit_words.h"
#include "vm/image.h"

using namespace tiniscript;

namespace tiniscript {

Receiver receiver;  // where `link/receiver.h` looks for it on an AVR

}  // namespace tiniscript

namespace {

TiniLink* instance = nullptr;
const uint8_t no_words[] tini_progmem = {0, 0};

uint32_t checksum_of(const uint8_t* image) {
  uint32_t checksum = 0;
  for (uint8_t k = kAfterChecksum; k-- > kChecksumAt;) checksum = checksum << 8 | image[k];
  return checksum;
}

bool show_on_link(int32_t value, bool is_yes_no) { return instance->show(value, is_yes_no); }

}  // namespace

TiniLink::TiniLink(TiniPlayer* player, const char* name, uint32_t id)
    : player_(player),
      link_(),
      identity_(),
      status_(),
      info_(),
      run_image_(live_),
      now_ms_(0),
      live_() {
  identity_.id = id;
  rename(reinterpret_cast<const uint8_t*>(name), static_cast<uint8_t>(strlen(name)));
  instance = this;
}

void TiniLink::begin(uint32_t random) {
  const TiniKit& kit = player_->kit();
  identity_.kit = kit.fingerprint();
  identity_.nonce = random;
  identity_.features = kPlaces;
  player_->show_by(show_on_link);
  link_.begin(&receiver, static_cast<uint8_t>(random));
}

void TiniLink::on_rx_byte(uint8_t byte, uint32_t now_ms) {
  if (receiver.put(byte, static_cast<uint16_t>(now_ms))) player_->stop();
}

void TiniLink::tick(uint32_t now_ms) {
  now_ms_ = now_ms;
  link_.pass_time(static_cast<uint16_t>(now_ms));
  link_.tick();
  if (is_running() && !link_.stop_is_due()) {
    player_->tick(now_ms);
    if (!player_->is_running()) {
      const uint8_t fault = static_cast<uint8_t>(player_->fault());
      end(fault != 0 ? State::kFaulted : State::kIdle);
      if (fault != 0) {
        record(fault);
        link_.on_faulted();
      } else {
        link_.on_done();
      }
    }
  }
  link_.send_due();
}

uint16_t TiniLink::room() const {
  return static_cast<uint16_t>(player_->room() - kHeaderBytes - kEndBytes);
}

Answer TiniLink::prepare_upload() {
  if (is_running()) end(State::kIdle);
  return Answer::kOk;
}

uint8_t* TiniLink::memory(uint16_t length, bool is_live) {
  const uint16_t room = is_live ? sizeof live_ : player_->room();
  if (length > room - kEndBytes) return nullptr;
  return is_live ? live_ : player_->memory();
}

void TiniLink::forget() {
  status_.program = 0;
  status_.length = 0;
  status_.saved = Saved::kNothing;
}

void TiniLink::take(bool is_live) {
  if (is_live) return;
  const uint8_t* const image = held_image();
  status_.length = static_cast<uint16_t>(image_length(image) - image[kHeaderLengthAt]);
  status_.saved = Saved::kMemory;
}

void TiniLink::take_checksum(const uint8_t* image) {
  if (image == held_image()) status_.program = checksum_of(image);
}

void TiniLink::start(bool is_live) {
  const uint8_t* const image = is_live ? live_ : held_image();
  const uint8_t header = image[kHeaderLengthAt];
  const uint16_t length = static_cast<uint16_t>(image_length(image) - header);
  run_image_ = image;
  status_.state = State::kRunning;
  status_.run++;
  const uint32_t seed = identity_.nonce ^ now_ms_;
  player_->start_code(image + header, length, now_ms_, seed != 0 ? seed : 1);
}

void TiniLink::end(State state) {
  player_->stop();
  player_->robot()->motors(0, 0);
  status_.state = state;
}

void TiniLink::record(uint8_t fault) {
  link_.write_checksum();  // the record has the checksum of its image
  status_.fault = fault;
  status_.fault_at = player_->fault_at();
  status_.fault_program = checksum_of(run_image_);
}

void TiniLink::stop(uint8_t fault) {
  const bool was_running = is_running();
  end(fault != 0 ? State::kFaulted : State::kStopped);
  if (was_running && fault != 0) record(fault);
}

void TiniLink::release() {
  if (status_.state >= State::kStopped) status_.state = State::kIdle;
}

bool TiniLink::rename(const uint8_t* name, uint8_t length) {
  if (length > kNameBytes) length = kNameBytes;
  memcpy(info_.name, name, length);
  info_.name_length = length;
  return true;
}

namespace tiniscript {

const DeviceInfo& port_device_info() { return instance->device_info(); }
uint8_t port_readings() { return instance->kit().sensors; }
uint8_t port_actuators() { return instance->kit().actuators; }
Identity& port_identity() { return instance->identity(); }
const RobotStatus& port_status() { return instance->status(); }
LineErrors port_line_errors() { return {0, 0}; }
uint16_t port_room() { return instance->room(); }
Answer port_prepare_upload(bool) { return instance->prepare_upload(); }
uint8_t* port_memory(uint16_t length, bool is_live) { return instance->memory(length, is_live); }
bool port_may_write_ahead() { return !instance->is_running(); }
void port_forget() { instance->forget(); }
void port_take(uint8_t, bool is_live) { instance->take(is_live); }
void port_take_checksum(const uint8_t* image) { instance->take_checksum(image); }
void port_start(bool is_live) { instance->start(is_live); }
void port_end() { instance->prepare_upload(); }
void port_stop(uint8_t fault) { instance->stop(fault); }
void port_release() { instance->release(); }
uint16_t port_run_at() { return instance->offset(); }
uint16_t port_shown_at() { return instance->shown_at(); }
const uint8_t* port_run_image() { return instance->run_image(); }
uint16_t port_image_length() { return image_length(instance->held_image()); }

Answer port_image_byte(uint16_t offset, uint8_t* byte) {
  *byte = instance->held_image()[offset];
  return Answer::kOk;
}

// A program is in RAM alone: there is none before it, and no name is kept over power-off.
Answer port_undo() { return Answer::kNoPrevious; }

Answer port_rename(const uint8_t* name, uint8_t length) {
  return instance->rename(name, length) ? Answer::kNotKept : Answer::kBadValue;
}

Answer port_tune(const Tuning&, bool) { return Answer::kNotKept; }

// Not measured: `Robot::speed` says how fast it is.
const Tuning& port_tuning() {
  static const Tuning none = {};
  return none;
}

void port_identify() {}

// No owner.
Answer port_key(uint8_t, uint8_t* key) {
  memset(key, 0, kKeyBytes);
  return Answer::kOk;
}

Answer port_keep_key(uint8_t, const uint8_t*) { return Answer::kNotKept; }

// No text: there is no memory for it.
uint8_t* port_text_memory(uint16_t* room, bool* has_room) {
  *room = 0;
  *has_room = false;
  return nullptr;
}

uint8_t* port_text_room(uint16_t*) { return nullptr; }
bool port_text_is_separate(bool) { return false; }
bool port_may_prepare_upload(bool) { return true; }
void port_take_text(uint8_t*, bool) {}
bool port_reads_keys() { return false; }
const uint8_t* robot_words() { return no_words; }
uint16_t robot_language() { return 0; }

}  // namespace tiniscript
