// The robot's half of the link: answers a client.
//
// Maps messages to `port.h`, and knows which events a client must be told. Bytes come in through a
// Receiver and go out through `next_tx_byte`; time comes in as `now_ms`. No function here blocks. A
// repeated request is answered again but not executed again. `docs/develop/link.md` is the
// contract.

#pragma once

#include <stdint.h>

#include "../vm/build.h"
#include "frames.h"
#include "messages.h"
#include "port.h"
#include "receiver.h"
#include "seal.h"

#ifdef tiniscript_without_text
#include "no_console.h"
#else
#include "console.h"
#endif

namespace tiniscript {

// An answer as a reply has it.
inline constexpr uint8_t number_of(Answer answer) { return static_cast<uint8_t>(answer); }
constexpr uint8_t kOkStatus = number_of(Answer::kOk);

class Link {
 public:
  // Members not listed here start as 0. `epoch` is any number, preferably a new one after each
  // reset.
  void begin(Receiver* receiver, uint8_t epoch);

  // Passes the time, at least once a minute, as only the lower bits of a time are kept.
  void pass_time(uint16_t now_ms);

  // Handles the received frames and text.
  void tick();

  // Whether `tick` would start a LIVE now: all other work may wait for that.
  bool has_due_live() const { return is_ready_ && receiver_->has_frame(); }

  // The memory of the image that was prepared is needed elsewhere: it must not start.
  void drop_ahead() { is_ready_ = false; }

  // Call it after the motors are served: writes the checksum of a program that came in one frame,
  // and starts to send due messages.
  void send_due();

  // Writes that checksum now, because it is needed.
  void write_checksum();

  // Whether there is a byte to send.
  bool has_tx_byte() const { return bytes_left_ != 0; }

  // The next byte to send, or false if there is none. May be called from an interrupt.
  bool next_tx_byte(uint8_t* byte);

  // The address of the data of `next_tx_byte`: an AVR's interrupt does it in assembly
  // (`link_avr.h`).
  struct Layout;

  // Whether a stop has arrived that `tick` has not handled yet: until then the motors must stay
  // off, whatever else was requested. Code that turns motors on checks this with interrupts off.
  bool stop_is_due() const {
    return receiver_->due_stop() != Cause::kNone || receiver_->has_mark();
  }

  // Events. The first three are sent when there is room; a value that finds no room is rejected,
  // and the caller tries again.
  void on_done();
  void on_faulted();  // port_status() has the record
  void on_stopped(Cause cause);
  void on_halted();
  // Whether a program may halt: a client is there to continue it.
  bool may_halt() const { return is_listened_to() && !is_dead_man_over(); }
  bool show(int32_t value, bool is_yes_no);

  // The button starts the program that the robot holds: cancels a program in transfer, which must
  // not overwrite it. A run started by the button has no dead-man timer.
  void cancel_and_detach() {
    image_ = nullptr;
    is_attached_ = false;
    console_.drop();
    rights_ = 0;  // including one that only the teacher may release
  }

  // Whether the run ends when no frame arrives.
  bool is_attached() const { return is_attached_; }

  // The state of this session's remote control, or nullptr if it no longer counts. It lets all go,
  // and for how long it counts.
  const RemoteKeys* remote() const {
    return kHasRemote && left_ms_[kHold] != 0 ? &remote_ : nullptr;
  }
  void let_go() {
    if (kHasRemote) left_ms_[kHold] = 0;
  }
  uint16_t remote_ms() const { return left_ms_[kHold]; }

  // Ends the authority of the session.
  void expire();

  // The button confirms a claim, if the session has asked for one. Returns whether it has.
  bool confirm_claim();

  // For `Links`: one of several links.

  // Has this link make other challenges than those that begin with another number.
  void begin_challenges(uint8_t number) { challenge_[0] = number; }

  // Whether a client is heard, and whether anyone receives what a program shows.
  bool is_heard() const { return left_ms_[kListen] > kListenMs - kAuthorityMs; }
  bool takes_values() const { return is_listened_to() || talks(); }

  bool has_asked_for_claim() const { return (rights_ & kIsAsked) != 0; }

  // Whether only the teacher releases the robot.
  bool is_held_back() const { return (rights_ & kHeldBack) != 0; }
  void hold_back(bool is_held_back) {
    rights_ = static_cast<uint8_t>(is_held_back ? rights_ | kHeldBack : rights_ & ~kHeldBack);
  }

  Cause cause() const { return cause_; }

  // Whether this session is told the readings of programs.
  bool tells_readings() const { return kTellsReadings && tells_readings_; }

  // Whether the last request was carried out.
  bool has_done() const { return reply_.status == static_cast<uint8_t>(Answer::kOk); }

  // Another session drives: an upload or line that this one has begun is over.
  void give_way() {
    image_ = nullptr;
    is_attached_ = is_ready_ = false;
    let_go();
    console_.drop();
    if (kTellsReadings) forget_readings();
  }

  // The client has left: the next one begins a session.
  void forget_client() {
    if (kHasBreakpoints) forget_breakpoints();
    if (kTellsReadings) forget_readings();
    is_open_ = false;
    due_ = 0;
    bytes_left_ = 0;
    left_ms_[kListen] = left_ms_[kFrameSent] = 0;
    console_.forget_client();
  }

  // Whether a stop came since the last call, even if the robot was stopped already: text typed
  // before that, in any session, is discarded.
  bool take_was_stopped() {
    const bool was_stopped = was_stopped_;
    was_stopped_ = false;
    return was_stopped;
  }
  void discard_text() { drop_answer(); }

  bool has_open_text() const { return console_.is_open(); }
  void drop_text() { console_.drop(); }

  // The firmware's functions of `Links`, for a robot with several.
  static void expire_others() {}
  static constexpr bool is_driving() { return true; }
  static constexpr bool take_text_memory() { return true; }

 private:
  // The messages due to be sent, one bit each: the lowest one first.
  static constexpr uint8_t kDueStopped = 1;
  static constexpr uint8_t kDueReply = 2;
  static constexpr uint8_t kDueFault = 4;
  static constexpr uint8_t kDueDone = 8;
  static constexpr uint8_t kDueHalted = 16;
  static constexpr uint8_t kDueText = kHasBreakpoints ? 32 : 16;

  // A run's end comes after its readings.
  static constexpr uint8_t kBeforeReadings = static_cast<uint8_t>(~(kDueFault | kDueDone));

  // Times that run down to 0: until a client without frames no longer counts as listening, until
  // STOPPED is sent again, until a second of silence has passed, until text may follow the last
  // frame, until the remote control says nothing any more, until HALTED is sent again; and, as
  // `kListen`, since a sealed frame.
  enum Time : uint8_t { kListen, kAgain, kSilence, kFrameSent, kHold, kHaltedAgain, kSealHeard };
  static constexpr uint8_t kTimes = kMaySeal          ? kSealHeard + 1
                                    : kHasBreakpoints ? kSealHeard
                                    : kHasRemote      ? kHaltedAgain
                                                      : kHold;

  // Rights of the session, one bit each: it has a challenge, it has asked for a claim, the button
  // has confirmed that. And the robot was stopped with the teacher's key.
  static constexpr uint8_t kHasChallenge = 1;
  static constexpr uint8_t kIsAsked = 2;
  static constexpr uint8_t kIsConfirmed = 4;
  static constexpr uint8_t kHeldBack = 8;

  // The value that SHOW sends.
  struct tini_packed ShownValue {
    int32_t value;
    bool is_yes_no;
    uint8_t run;
    uint16_t offset;
  };

  // A reply before it is written. The detail follows a status other than OK.
  struct Reply {
    uint8_t number;
    uint8_t seq;
    uint8_t status;
    uint16_t detail;
  };

  // The purpose of an image: to be stored, to run once, or to run as soon as its frame ends.
  enum class Use : uint8_t { kStored, kLive, kAhead };

  // frames and their answers: `link.cpp`, in the order of their calls
  void pass(uint16_t now_ms);
  void end_silence(bool is_held, bool is_at_stop, uint16_t previous_ms);
  void turn();
  void stop(Cause cause);
  void take_arrived();
  void on_frame();
  bool is_next(uint8_t seq, uint8_t epoch) const;
  void handle(uint8_t end);
  uint8_t answer(Message message, const uint8_t* payload, uint8_t length);
  static Answer missing_program_answer();
  Answer clear();
  Answer set_trim(const uint8_t* payload, uint8_t length);
  Answer hold(const RemoteKeys& remote_keys);
  uint8_t hello(const uint8_t* payload);
  void renew();

  // programs: `link_programs.cpp`
  void make_ahead();
  bool go_live();
  uint8_t refuse(Answer answer, uint16_t detail);
  uint8_t allow(uint8_t mode, const uint8_t* isa);
  uint8_t make_room(Use use, uint16_t length);
  uint8_t fill(Use use, const uint8_t* payload, uint8_t length);
  uint8_t make(Use use, uint8_t start, const uint8_t* code, uint8_t length, bool is_other_kit);
  uint8_t take_short(bool is_live, const uint8_t* payload, uint8_t length);
  uint8_t begin_program(const uint8_t* payload);
  uint8_t add_data(const uint8_t* payload, uint8_t length);
  uint8_t commit(const uint8_t* payload);
  void finish(uint8_t mode, bool is_live);
  void start(uint8_t mode, bool is_live);

  // owners: `link_owners.cpp`
  bool is_forbidden(uint8_t type) const;
  bool is_authorized(bool has_right) const;
  Answer claim(const uint8_t* payload, uint8_t length);
  uint8_t authenticate(const uint8_t* payload, uint8_t length);
  Answer allow_text(const uint8_t* payload);

  void note_stop() {
    if (kHasTransports) was_stopped_ = true;
  }

  // `link_wifi.cpp`
  uint8_t set_wifi(const uint8_t* payload, uint8_t length);
  void tell_wifi();

  // seals: `link_seals.cpp`
  bool may_seal() const {
    return kMaySeal && (port_identity().more_features & kMoreSeals) != 0;
  }
  bool has_seal() const { return kMaySeal && seal_.is_set(); }
  // Whether the current request is sealed with it.
  bool is_sealed() const { return kMaySeal && is_sealed_; }
  void begin_request() {
    if (kMaySeal) is_sealed_ = is_reply_sealed_ = false;
  }
  uint8_t open_seal(uint8_t end);
  void close_seal();
  void begin_seal(const uint8_t* key, uint8_t kind);
  void drop_seal() {
    if (kMaySeal) seal_.drop();
  }
  bool keeps_answer(uint8_t type) const;
  void forget_answer() {
    if (kMaySeal) last_sealed_reply_.number = 0;
  }
  Reply& last_reply() { return is_sealed() ? last_sealed_reply_ : last_reply_; }
  uint8_t& last_epoch() { return is_sealed() ? last_sealed_epoch_ : last_epoch_; }
  uint16_t dead_man_ms() const {
    return left_ms_[kMaySeal && is_run_sealed_ ? kSealHeard : kListen];
  }
  void note_run() {
    if (kMaySeal) is_run_sealed_ = is_sealed_;
  }
  uint8_t reply_mark() { return kMaySeal && is_reply_sealed_ ? event_mark() : 0; }
  uint8_t event_mark() { return has_seal() ? seal_mark() : 0; }
  uint8_t seal_mark();

  // text: `link_text.cpp`
  bool talks() const { return console_.is_talking() && !is_listened_to(); }
  void talk();
  void drop_answer();
  Remark start_text(const Console& console);
  void send_text();
  void show_text(int32_t value, bool is_yes_no);
  // Whether the image that was taken last was typed: no receipt reports its checksum.
  bool is_typed() const { return kHasText && is_typed_; }
  void note_typed(bool is_typed) {
    if (kHasText) is_typed_ = is_typed;
  }

  // breakpoints: `link_breakpoints.cpp`
  Answer set_breakpoints(const uint8_t* places, uint8_t length);
  Answer resume(uint8_t mode);
  void forget_breakpoints();
  void tell_halt();
  void tell_tasks();
  void tell_variables();

  // readings: `link_readings.cpp`
  void tell_readings(bool is_on);
  void forget_readings() {
    if (tells_readings_) tell_readings(false);
  }
  bool has_reading() const {
    return kTellsReadings && tells_readings_ && is_listened_to() && port_has_reading();
  }
  bool has_late_value() const { return kTellsReadings && has_late_value_; }
  bool has_due() const { return due_ != 0 || has_late_value() || has_reading(); }
  bool is_free_without_readings() const;
  void catch_up();
  void pass_readings(uint16_t passed_ms);
  bool keep_value(int32_t value, bool is_yes_no);
  void send_late_value();
  void send_reading();

  // writing: `link_writing.cpp`
  bool is_listened_to() const;
  void note_end(uint8_t due);
  void confirm(Cause cause);
  void send();
  bool is_dead_man_over() const { return dead_man_ms() <= kListenMs - kDeadManMs; }
  bool owns_halt() const { return kHasBreakpoints && owns_halt_ && port_is_halted(); }
  void reply();
  void describe();
  void fetch();
  void begin_frame(uint8_t type, uint8_t seq);
  void begin_event(Message message);
  void put(uint8_t byte);
  void put16(uint16_t value);
  void put_all(const void* bytes, uint8_t length);
  void close();
  bool sends_separator();
  void hand_over();
  void hand_over_frame();

  ReceiverOfLink receiver_;
  FrameCheck check_;  // of the packet that arrives or waits
  uint16_t now_ms_;
  uint16_t left_ms_[kTimes];
  uint8_t epoch_;
  uint8_t damaged_;    // number of damaged frames
  uint8_t due_;        // due messages
  uint8_t isa_[2];     // of the client's programs, major and minor
  bool is_open_;       // there is a session
  bool is_other_kit_;  // the client's programs are for another kit
  bool is_attached_;   // of the current or last run
  uint8_t ended_run_;
  Cause cause_;
  uint8_t event_seq_;
  uint8_t last_epoch_;
  uint8_t rights_;
  Reply last_reply_;   // the last reply to a numbered request
  Reply reply_;        // the current reply
  uint32_t checksum_;  // of the image in a receipt
  // The long program in transfer.
  uint8_t* image_;  // or nullptr
  uint8_t mode_;
  uint16_t length_;                  // number of bytes after the checksum
  uint16_t next_;                    // offset of the next one
  uint8_t* image_without_checksum_;  // the taken image without a checksum yet, or nullptr
  uint8_t* last_image_;              // the image that was made last
  uint8_t ahead_end_;                // end of the payload of an image made ahead, or 0
  bool is_ready_;                    // it is `made_image_`, and may start if the frame ends there
  // Output.
  uint8_t size_;                 // bytes written so far
  uint8_t sent_;                 // bytes already sent
  volatile uint8_t bytes_left_;  // bytes left to send
  tini_with_text bool is_typed_;
  // Large members come last: members near the beginning take less code.
  Console console_;
  tini_with_seals bool is_sealed_;  // the current request
  tini_with_seals bool is_reply_sealed_;
  tini_with_seals bool is_run_sealed_;  // the current or last run was started by a sealed request
  tini_with_seals uint8_t last_sealed_epoch_;
  tini_with_seals Reply last_sealed_reply_;  // the last reply to a sealed request
  tini_with_seals Seal seal_;
  tini_with_transports bool was_stopped_;
  tini_with_breakpoints bool has_breakpoints_;  // of this session
  tini_with_breakpoints bool owns_halt_;  // it was told about the last halt: that ends with it
  tini_with_readings bool tells_readings_;  // to this session
  tini_with_readings bool has_late_value_;
  tini_with_readings uint8_t lag_bytes_;  // the number of bytes by which readings delay the line
  tini_with_readings uint8_t late_value_epoch_;
  tini_with_readings uint8_t reply_bytes_;  // of the last one
  tini_with_readings ShownValue late_value_;
  tini_with_remote RemoteKeys remote_;  // the last state of the remote control
  uint32_t nonce_;  // of the session
  uint8_t challenge_[kChallengeBytes];
  uint8_t out_[kWireBytes];
};

}  // namespace tiniscript
