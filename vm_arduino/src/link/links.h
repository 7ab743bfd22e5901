// The links of a robot that is reached over several transports at once: one for each, and the one
// that drives.
//
// Each transport has its own receiver, session and seal, so a client's HELLO does not end another
// session. A session drives from its first request that acts on; for 2 s after each, and while it
// is heard and its program runs, those of others are refused. Messages for all (HELLO, PING,
// STATUS, STOP, IDENTIFY) are answered on each, and a stop on one is a stop. Knows no bytes of a
// transport. All calls are the main loop's.

#pragma once

#include <stdint.h>

#include "link.h"
#include "port.h"
#include "transports.h"

namespace tiniscript {

class Links {
 public:
  // The same as in Link, for all of them.
  void begin(uint8_t epoch);
  void pass_time(uint16_t now_ms);
  void tick();
  void send_due();
  void write_checksum();
  bool has_due_live() const;
  bool stop_is_due() const;
  void on_done();
  void on_faulted();
  void on_stopped(Cause cause);
  void on_halted();
  bool may_halt() const;
  void cancel_and_detach();
  bool is_attached() const;
  bool tells_readings() const;
  void expire();
  bool confirm_claim();
  void let_go();

  // The newest word of a remote control, or nullptr.
  const RemoteKeys* remote() const;

  // To the driver; without one, to the first listener.
  bool show(int32_t value, bool is_yes_no);

  // The receiver and the bytes of a transport.
  Receiver& receiver(Transport transport) { return receivers_[place_of(transport)]; }
  bool next_tx_byte(Transport transport, uint8_t* byte) {
    return links_[place_of(transport)].next_tx_byte(byte);
  }

  // The client has left: the authority of that session ends. Returns whether a run ends with it.
  bool end_session(Transport transport);

  // The keys have changed: ends the authority of all sessions but the one that has asked.
  void expire_others();

  // Whether the current request (its type, or 0 for a line of text) may be carried out, or why not.
  // Its session drives from now on, if it is a driver's request and is not refused.
  Answer may_drive(uint8_t type);

  // Whether a line of text may press keys now.
  bool may_press() const;

  // Whether the current session drives already.
  bool is_driving() const { return driver_ == current_place_; }

  // Whether the session of a transport has authenticated.
  bool has_key(Transport transport) const { return key_rights_[place_of(transport)] != 0; }

  // A line of text of the current session begins. False: another one has the memory for it now.
  bool take_text_memory();

  // Text has its own memory: a prepared image stays.
  static void drop_ahead() {}

 private:
  static constexpr uint8_t kNobody = 0xff;

  static uint8_t place_of(Transport transport) { return static_cast<uint8_t>(transport); }
  bool is_driven() const;
  bool keeps_control() const;
  uint8_t listener() const;
  void drive();
  void enter(uint8_t place);
  void leave();
  void spread_events(State previous_state);

  Link links_[kTransports];
  Receiver receivers_[kTransports];
  uint8_t key_rights_[kTransports];      // kYours of each session
  uint8_t teacher_rights_[kTransports];  // kMoreByTeacher of each
  uint8_t current_place_;                // the current one
  uint8_t driver_;                       // or kNobody
  uint16_t now_ms_;
  uint16_t driving_ms_;  // how long its last request counts, whatever is received
  bool is_held_back_;
  bool is_asking_;  // the current session, to drive
  bool is_asking_by_text_;
};

}  // namespace tiniscript
