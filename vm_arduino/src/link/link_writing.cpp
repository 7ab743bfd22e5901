// Writes replies and events, field by field as in the table of messages.

#include "../vm/bytecode.h"
#include "../vm/cpu.h"
#include "../vm/image.h"
#include "../vm/small.h"
#include "link.h"
#include "port.h"

namespace tiniscript {

namespace {

// The first part of the reply to HELLO.
const uint8_t kVersions[] tini_progmem = {kLinkMajor, kLinkMinor,    kIsaMajor,
                                          kIsaMinor,  kLargestFrame, kWindow};

constexpr uint8_t kPulseBytes = 2;  // state and run of a RobotStatus
constexpr uint8_t kPlaceBytes = 2;  // its slot and `saved`

// Bytes of the image in a small reply to FETCH, which also has a status and a length.
constexpr uint8_t kSmallFetch = kSmallFrame - kHeadBytes - kCrcBytes - 3;

static_assert(sizeof(Identity) == 13 && sizeof(RobotStatus) == 17, "they are as they are sent");

template <class Type>
uint8_t byte_of(Type value) {
  return static_cast<uint8_t>(value);
}

// Two bytes as one number: on an AVR that is less code than one after the other.
uint16_t word_of(uint8_t first, uint8_t second) {
  const uint8_t bytes[] = {first, second};
  uint16_t word;
  __builtin_memcpy(&word, bytes, sizeof word);
  return word;
}

}  // namespace

void Link::on_done() { note_end(kDueDone); }

void Link::on_faulted() {
  renew();
  note_end(kDueFault);
}

// If two ends wait for the line, the last one is reported: an end is never reported for another
// run.
void Link::note_end(uint8_t due) {
  ended_run_ = port_status().run;
  due_ = static_cast<uint8_t>((due_ & ~(kDueFault | kDueDone)) | due);
}

void Link::on_stopped(Cause cause) {
  renew();
  cause_ = cause;
  left_ms_[kAgain] = 0;
  confirm(cause);
}

// Text typed before a stop is discarded. It is reported at a limited rate, to a client as a frame.
tini_noinline void Link::confirm(Cause cause) {
  if (kHasText) drop_answer();
  if (cause <= Cause::kMessage) console_.hang_up();  // one that is for computers
  if (cause == Cause::kText) console_.pick_up();
  if (left_ms_[kAgain] != 0) return;
  left_ms_[kAgain] = kAgainMs;
  due_ |= kDueStopped;
}

tini_noinline bool Link::show(int32_t value, bool is_yes_no) {
  const bool is_heard = is_listened_to();
  if (!is_heard && !console_.is_talking()) return true;
  // An answer in text waits until no frames come: a value for a client does not wait for that.
  const uint8_t waited_for = is_heard ? static_cast<uint8_t>(~kDueText) : 0xff;
  const bool is_busy = bytes_left_ != 0 || (due_ & waited_for) != 0;
  if (is_busy && !(kTellsReadings && is_heard && is_free_without_readings())) return false;
  if (has_late_value()) return false;
  if (!is_heard) {
    if (left_ms_[kFrameSent] != 0) return false;
    if (kHasText) show_text(value, is_yes_no);
    return true;
  }
  if (kTellsReadings && keep_value(value, is_yes_no)) return true;
  if (sends_separator()) return false;
  const ShownValue shown_value = {value, is_yes_no, port_status().run, port_shown_at()};
  begin_event(Message::kShow);
  put_all(&shown_value, sizeof shown_value);
  close();
  return true;
}

// A robot that runs alone has no client that reads.
bool Link::is_listened_to() const { return is_open_ && left_ms_[kListen] != 0; }

// Sends the first message that is due. A client that has sent the stop sequence is listening.
void Link::send() {
  if (kHasText && talks()) return send_text();
  if (!is_listened_to()) due_ &= static_cast<uint8_t>(~(kDueFault | kDueDone));
  if (kHasBreakpoints && (!is_listened_to() || !port_is_halted())) {
    due_ &= static_cast<uint8_t>(~kDueHalted);
  }
  const uint8_t next_due = static_cast<uint8_t>(due_ & -due_);
  if (kTellsReadings && has_late_value_ && next_due != kDueReply) return send_late_value();
  if (kTellsReadings && (next_due & kBeforeReadings) == 0 && has_reading()) return send_reading();
  if (next_due == 0) return;
  if (kHasText && next_due == kDueText) return send_text();
  if (sends_separator()) return;
  due_ ^= next_due;
  if (next_due == kDueReply) {
    reply();
  } else if (next_due == kDueStopped) {
    begin_event(Message::kStopped);
    put(byte_of(cause_));
  } else if (kHasBreakpoints && next_due == kDueHalted) {
    tell_halt();
  } else {
    begin_event(next_due == kDueFault ? Message::kFault : Message::kDone);
    put(ended_run_);
    if (next_due == kDueFault) put_all(&port_status().fault, kFaultBytes);
  }
  close();
  if (kTellsReadings && next_due == kDueReply) reply_bytes_ = size_;
}

void Link::reply() {
  begin_frame(reply_.number | kReply | reply_mark(), reply_.seq);
  put(reply_.status);
  if (reply_.status != byte_of(Answer::kOk)) {
    put16(reply_.detail);
    return;
  }
  const RobotStatus& robot_status = port_status();
  switch (static_cast<Message>(reply_.number)) {
    case Message::kHello:
      describe();
      break;
    case Message::kPing:
    case Message::kKeys:
      put_all(&robot_status, kPulseBytes);
      if (byte_of(reply_.detail) != 0 && robot_status.state == State::kRunning) {
        put16(port_run_at());
        put_all(port_run_image() + kChecksumAt, kChecksumBytes);
      }
      break;
    case Message::kStatus:
      put_all(&robot_status, sizeof robot_status);
      put16(word_of(byte_of(damaged_ + receiver_->damaged()), receiver_->dropped()));
      put16(word_of(port_line_errors().framing, port_line_errors().overrun));
      uint16_t edges;
      if (kHasDiscs && port_noise(&edges)) put16(edges);
      break;
    case Message::kFetch:
      fetch();
      break;
    case Message::kStart:
    case Message::kLive:
    case Message::kProgram:
    case Message::kCommit:
    case Message::kUndo:
      put_all(&checksum_, sizeof checksum_);
      put(robot_status.run);
      put_all(&robot_status.slot, kPlaceBytes);
      break;
    case Message::kBegin:
    case Message::kData:
      put16(next_);
      break;
    case Message::kTrim:
      put_all(&port_tuning(), sizeof(Tuning));
      break;
    case Message::kAuthenticate:
    case Message::kText:
      put_all(&port_identity().features, kFeaturesBytes);
      if (reply_.number == byte_of(Message::kAuthenticate) && (rights_ & kHasChallenge) != 0)
        put_all(challenge_, kChallengeBytes);
      break;
    case Message::kResume:
      if (!kHasBreakpoints) break;
      put(robot_status.run);
      put(byte_of(reply_.detail));
      break;
    case Message::kReadVariables:
      if (kHasBreakpoints) tell_variables();
      break;
    case Message::kReadTasks:
      if (kHasBreakpoints) tell_tasks();
      break;
    case Message::kWifi:
      if (kHasTransports) tell_wifi();
      break;
    default:  // OK says it all
      break;
  }
}

void Link::describe() {
  for (const uint8_t& byte : kVersions) put(flash_byte(&byte));
  put_all(&port_identity(), sizeof(Identity));
  put16(port_room());
  put_all(&port_status(), sizeof(RobotStatus));
  const DeviceInfo& device_info = port_device_info();
  put_all(device_info.name, device_info.name_length);
}

void Link::fetch() {
  const uint16_t length = port_image_length();
  const uint8_t answer_at = kHasSeals ? static_cast<uint8_t>(size_ - 1) : kPayloadAt;
  const bool is_sealed = answer_at != kPayloadAt;
  const uint8_t max_size =
      static_cast<uint8_t>(kLargestFrame + kTypeAt - kCrcBytes - (is_sealed ? kTagBytes : 0));
  if (kHasLargeFrames && !is_sealed && reply_.detail + kSmallFetch < length) {
    put(out_[answer_at]);
    out_[answer_at] = 0;
  }
  put16(length);
  for (uint16_t offset = reply_.detail; offset < length && size_ < max_size; offset++) {
    const Answer answer = port_image_byte(offset, out_ + size_++);
    if (answer != Answer::kOk) {
      size_ = answer_at;
      put(byte_of(answer));
      put16(0);
      return;
    }
  }
}

tini_noinline void Link::begin_event(Message message) {
  begin_frame(byte_of(message) | kReply | event_mark(), event_seq_++);
}

tini_noinline void Link::begin_frame(uint8_t type, uint8_t seq) {
  out_[kTypeAt] = type;
  out_[kSeqAt] = seq;
  out_[kEpochAt] = epoch_;
  size_ = kHasSeals && (type & kSealed) != 0 ? kSealedPayloadAt : kPayloadAt;
}

tini_noinline void Link::put(uint8_t byte) { out_[size_++] = byte; }

tini_noinline void Link::put16(uint16_t value) {
  put(byte_of(value));
  put(byte_of(value >> 8));
}

tini_noinline void Link::put_all(const void* bytes, uint8_t length) {
  copy_bytes(bytes, out_ + size_, length);
  size_ = static_cast<uint8_t>(size_ + length);
}

void Link::close() {
  if (kHasSeals && (out_[kTypeAt] & kSealed) != 0) size_ = seal_.close(out_, size_);
  size_ = encode_frame(out_, size_);
  hand_over_frame();
}

// Sends the 0x00 that is before a frame, unless frames have come until now. False: none is needed.
bool Link::sends_separator() {
  if (left_ms_[kFrameSent] > kTextMs - kZeroMs) return false;
  size_ = 0;
  put(0);
  hand_over_frame();
  return true;
}

void Link::hand_over_frame() {
  left_ms_[kFrameSent] = kTextMs;
  hand_over();
}

// From here on, the interrupt may send the message: it is complete.
void Link::hand_over() {
  sent_ = 0;
  asm volatile("" ::: "memory");
  bytes_left_ = size_;
}

}  // namespace tiniscript
