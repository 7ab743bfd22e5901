// The robot's half of the link for a sketch of your own: `tsc upload`, `live`, `stop` and the
// others work with it, over whatever carries bytes.
//
// It keeps a program in RAM alone: what is sent is gone after power-off. It knows no owner, no trim
// and no text. `tsc doctor --conform --port P` passes.

#pragma once

#include "TiniScript.h"
#include "link/link.h"
#include "link/port.h"

class TiniLink {
 public:
  // The player's memory holds the program. `name` has up to 16 bytes; `id` tells this robot from
  // others. There is one link in a sketch.
  TiniLink(TiniPlayer* player, const char* name, uint32_t id);

  // Begins. `random` should be another number after each reset: noise of an open analog input.
  void begin(uint32_t random);

  // A byte has come. The motors are off when it completes a stop.
  void on_rx_byte(uint8_t byte, uint32_t now_ms);

  // Goes on, with the program too: call it in each turn of loop() in the place of the player's.
  void tick(uint32_t now_ms);

  // The next byte to send, or false.
  bool next_tx_byte(uint8_t* byte) { return link_.next_tx_byte(byte); }

  // For the link: `link/port.h`.
  tiniscript::Answer prepare_upload();
  uint8_t* memory(uint16_t length, bool is_live);
  void forget();
  void take(bool is_live);
  void take_checksum(const uint8_t* image);
  void start(bool is_live);
  void end(tiniscript::State state);
  void stop(uint8_t fault);
  void release();
  bool rename(const uint8_t* name, uint8_t length);
  bool show(int32_t value, bool is_yes_no) { return link_.show(value, is_yes_no); }
  bool is_running() const { return status_.state == tiniscript::State::kRunning; }
  uint16_t offset() const { return player_->fault_at(); }
  uint16_t shown_at() const { return player_->shown_at(); }
  const uint8_t* run_image() const { return run_image_; }
  const uint8_t* held_image() const { return player_->memory(); }
  uint16_t room() const;
  const tiniscript::DeviceInfo& device_info() const { return info_; }
  const TiniKit& kit() const { return player_->kit(); }
  tiniscript::Identity& identity() { return identity_; }
  const tiniscript::RobotStatus& status() const { return status_; }

 private:
  void record(uint8_t fault);

  TiniPlayer* player_;
  tiniscript::Link link_;
  tiniscript::Identity identity_;
  tiniscript::RobotStatus status_;
  tiniscript::DeviceInfo info_;
  const uint8_t* run_image_;  // of the current or last run
  uint32_t now_ms_;
  uint8_t live_[tiniscript::kHeaderBytes + tiniscript::kPayloadBytes + tiniscript::kEndBytes];
};
