// Answers a computer: the robot's half of the link.
//
// Knows what each message asks of `port.h`, and what a computer must be told. Bytes come through a
// Receiver and go out through `next_tx_byte`; time comes in as `now_ms`. Nothing here waits. A
// request that comes again is answered again and never done twice. `docs/link.md` is the contract.

#ifndef TINISCRIPT_LINK_LINK_H_
#define TINISCRIPT_LINK_LINK_H_

#include <stdint.h>

#include "frames.h"
#include "messages.h"
#include "receiver.h"

namespace tiniscript {

class Link {
 public:
  // All else is 0 at the beginning. `epoch` is any number, best another one after each reset.
  void begin(Receiver* receiver, uint8_t epoch);

  // Handles what has arrived: at least once a minute, for the lower bits of a time are enough.
  void tick(uint16_t now_ms);

  // Then, for the motors come first: seals a program that came in one frame, and begins to send
  // what is due.
  void tell();

  // Seals that program now: somebody wants to know its checksum.
  void seal();

  // The next byte to send; false where there is none. It may be called from an interrupt.
  bool next_tx_byte(uint8_t* byte);

  // Whether a stop has arrived that `tick` has not handled yet: until then the motors stay off,
  // whatever else was asked. Whoever writes their pins asks this, with interrupts off.
  bool stop_is_due() const { return receiver_->stop_is_due(); }

  // What the robot tells. The first three are told when there is room; a value that finds no room
  // is not taken, and comes again.
  void done();
  void faulted();  // the record is in port_condition()
  void stopped(Cause cause);
  bool show(int32_t value, bool is_yes_no);

  // The button starts what the robot holds: a program on its way must not be written over it, and
  // what starts has no tether.
  void drop() {
    image_ = nullptr;
    is_tethered_ = false;
  }

  // Whether what runs ends when no frame comes.
  bool is_tethered() const { return is_tethered_; }

 private:
  // what is due, one bit each
  static constexpr uint8_t kDueReply = 1;
  static constexpr uint8_t kDueStopped = 2;
  static constexpr uint8_t kDueFault = 4;
  static constexpr uint8_t kDueDone = 8;
  static constexpr uint8_t kDueHint = 16;

  // An answer before it is written. The detail follows a status that is not OK.
  struct Said {
    uint8_t number;
    uint8_t seq;
    uint8_t status;
    uint16_t detail;
  };

  void turn(uint16_t now_ms);
  void hear();
  void halt(Cause cause);
  void handle(uint8_t end);
  uint8_t answer(Message message, const uint8_t* payload, uint8_t length);
  Answer set_trim(const uint8_t* payload, uint8_t length);
  uint8_t hello(const uint8_t* payload);
  uint8_t take_short(bool is_live, const uint8_t* payload, uint8_t length);
  uint8_t begin_program(const uint8_t* payload);
  uint8_t add_data(const uint8_t* payload, uint8_t length);
  uint8_t commit(const uint8_t* payload);
  void put_checksum(uint8_t* image);
  void finish(bool is_live);
  void start(uint8_t mode, bool is_live);
  uint8_t refuse(Answer answer, uint16_t detail);
  uint8_t check(uint8_t mode, const uint8_t* header);
  uint8_t make_room(uint8_t mode, const uint8_t* header, bool is_live);
  void append(const uint8_t* code, uint8_t length);
  bool is_listened_to() const;
  void renew();

  // writing
  void send();
  bool is_own_hint() const;
  void reply();
  void describe();
  void fetch();
  void begin_frame(uint8_t type, uint8_t seq);
  void begin_event(Message message);
  void put(uint8_t byte);
  void put16(uint16_t value);
  void put_all(const void* bytes, uint8_t length);
  void close();
  void hand_over();

  Receiver* receiver_;
  uint16_t now_ms_;
  uint16_t quiet_ms_;  // since the last valid frame, up to kListenMs
  uint32_t nonce_;     // of the session
  uint16_t text_ms_;   // for which no line of text may come before one is answered again
  uint8_t again_ms_;   // for which STOPPED is not told again
  uint8_t epoch_;
  uint8_t damaged_;    // frames
  uint8_t due_;        // what there is to tell
  uint8_t isa_[2];     // of the computer's programs, major and minor
  bool is_open_;       // there is a session
  bool is_other_kit_;  // for which they are
  bool is_tethered_;   // what runs, or ran last
  uint8_t ended_run_;
  Cause cause_;
  uint8_t event_seq_;
  uint8_t last_epoch_;
  Said last_;          // what was answered last of what is numbered
  Said said_;          // what is answered now
  uint32_t checksum_;  // of the image that a receipt is about
  // the longer program that is on its way
  uint8_t* image_;  // or nullptr
  uint8_t mode_;
  uint16_t length_;
  uint16_t next_;
  uint8_t* unsealed_;  // the image that was taken and has no checksum yet, or nullptr
  // what goes out
  uint8_t size_;           // of what is being written
  uint8_t sent_;           // of what is written
  volatile uint8_t left_;  // of that
  uint8_t out_[kWireBytes];
};

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_LINK_H_
