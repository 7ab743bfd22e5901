#include "link.h"

#include "../vm/build.h"
#include "../vm/bytecode.h"
#include "../vm/image.h"
#include "../vm/small.h"
#include "port.h"
#include "run_down.h"

namespace tiniscript {

namespace {

constexpr uint8_t kLiveByte = static_cast<uint8_t>(Message::kLive);

// Whether a frame whose payload ends at `end` begins as one of its length does: a large one has a 0
// before its payload. `link_seals.cpp` looks at those that are sealed.
bool has_right_start(const uint8_t* bytes, uint8_t end) {
  return !is_large(end) || bytes[kPayloadAt] == 0;
}

}  // namespace

// The reason why the robot has no program to start or to fetch, or kOk.
Answer Link::missing_program_answer() {
  const Saved saved = port_status().saved;
  if (saved == Saved::kOtherVersion) return static_cast<Answer>(Refusal::kOtherVersion);
  return saved == Saved::kNothing ? Answer::kNoProgram : Answer::kOk;
}

void Link::begin(Receiver* receiver, uint8_t epoch) {
  receiver_ = receiver;
  epoch_ = epoch;
}

void Link::pass_time(uint16_t now_ms) { near(this)->pass(now_ms); }

void Link::pass(uint16_t now_ms) {
  const uint16_t passed_ms = static_cast<uint16_t>(now_ms - now_ms_);
  now_ms_ = now_ms;
  // All that is known of a byte that arrives from here on is that it was heard, at the latest in
  // the next call.
  const bool is_held = receiver_->is_held();
  const bool is_at_stop = receiver_->is_at_stop();
  const bool is_line = receiver_->has_open_line();
  const bool has_heard = receiver_->take_has_heard();
  const uint16_t previous_silence_ms = left_ms_[kSilence];
  run_down(left_ms_, kTimes, passed_ms);
  if (kTellsReadings) pass_readings(passed_ms);
  if (kHasLargeFrames && bytes_left_ != 0 && left_ms_[kFrameSent] != 0)
    left_ms_[kFrameSent] = kTextMs;
  if (has_heard) {
    left_ms_[kSilence] = kSilenceMs;
  } else if (previous_silence_ms != 0) {
    end_silence(is_held, is_at_stop, previous_silence_ms);
    if (is_line && left_ms_[kSilence] == 0) console_.tell(Remark::kCut, is_listened_to());
  }
  console_.pass(passed_ms, left_ms_[kSilence]);
}

// The effect of silence after a typed stop: after kHeldMs if the bytes began as a frame, after
// kSilenceMs if its line has not ended.
inline void Link::end_silence(bool is_held, bool is_at_stop, uint16_t previous_ms) {
  constexpr uint16_t kHeldLeftMs = kSilenceMs - kHeldMs;
  const uint16_t left_ms = left_ms_[kSilence];
  if (is_held && previous_ms > kHeldLeftMs && left_ms <= kHeldLeftMs) return receiver_->stop();
  if (left_ms != 0 || !is_at_stop || port_status().state != State::kRunning) return;
  if (console_.is_in_block() && !receiver_->has_text()) return port_end();
  receiver_->stop();
}

void Link::tick() { near(this)->turn(); }

void Link::turn() {
  const Cause cause = receiver_->due_stop();
  if (cause != Cause::kNone) {
    receiver_->take_stop();  // cleared before it is handled, so that another stop is not lost
    stop(cause);
  }
  const bool is_there = receiver_->has_frame();  // the whole frame has arrived
  take_arrived();
  if (is_there && receiver_->frame_may_stop()) {
    receiver_->let_frame();
    if (!check_.is_whole()) stop(Cause::kText);
  }
  // A reply that is due goes first, and text last. Before a stop that waits among text no frame
  // does anything.
  if (is_there && (due_ & kDueReply) == 0 && !receiver_->has_mark()) {
    on_frame();
  } else if (console_.is_due() || receiver_->has_text()) {
    talk();
  }
  if ((is_attached_ || owns_halt()) && is_dead_man_over() &&
      port_status().state == State::kRunning) {
    port_stop(static_cast<uint8_t>(LinkFault::kLinkLost));
    on_faulted();
  }
  if (kHasOwners && left_ms_[kListen] <= kListenMs - kAuthorityMs) expire();
  if (owns_halt() && left_ms_[kHaltedAgain] == 0) on_halted();
}

void Link::send_due() {
  Link* const self = near(this);
  if (self->image_without_checksum_ != nullptr) self->write_checksum();
  if (kTellsReadings) self->catch_up();
  const bool is_due = kTellsReadings ? self->has_due() : self->due_ != 0;
  if (is_due && self->bytes_left_ == 0) self->send();
}

// Writes the checksum into an image that is complete otherwise.
tini_noinline void Link::write_checksum() {
  uint8_t* const image = image_without_checksum_;
  if (image == nullptr) return;
  image_without_checksum_ = nullptr;
  const uint32_t checksum = image_checksum(image, image_length(image));
  __builtin_memcpy(image + kChecksumAt, &checksum, sizeof checksum);
  if (!is_typed()) checksum_ = checksum;
  port_take_checksum(image);
}

bool Link::next_tx_byte(uint8_t* byte) {
  Link* const self = near(this);
  const uint8_t bytes_left = self->bytes_left_;
  if (bytes_left == 0) return false;
  self->bytes_left_ = static_cast<uint8_t>(bytes_left - 1);
  *byte = self->out_[self->sent_++];
  return true;
}

// Stops the robot. If it was stopped already, the epoch stays; otherwise a line that is held low
// would exhaust it. A waiting packet is from before the stop and therefore stale.
tini_noinline void Link::stop(Cause cause) {
  const bool was_stopped = port_status().state == State::kStopped;
  port_stop(0);
  const bool has_stale_frame = cause != Cause::kMessage && receiver_->has_frame();
  note_stop();
  if (!was_stopped || has_stale_frame) {
    on_stopped(cause);
  } else {
    confirm(cause);
  }
  if (cause == Cause::kText) console_.discard_briefly();
}

// Takes the bytes of a packet that have arrived; a LIVE is made when all of its payload has.
inline void Link::take_arrived() {
  if (receiver_->take_has_begun()) {
    check_.begin();
    ahead_end_ = 0;
  }
  const uint8_t length = receiver_->length();
  if (length == check_.taken_count()) return;
  asm volatile("" ::: "memory");  // barrier: the interrupt has written the bytes before the length
  check_.take(receiver_->bytes(), length < kPacketBytes ? length : kPacketBytes);
  if (check_.remaining() <= kCrcBytes && receiver_->bytes()[kTypeAt] == kLiveByte) make_ahead();
}

// Answers a frame.
void Link::on_frame() {
  begin_request();
  if (is_ready_ && ahead_end_ + kCrcBytes == receiver_->length() && go_live()) {
    due_ |= kDueReply;
  } else if (!check_.is_whole()) {
    damaged_++;
  } else {
    const uint8_t end = check_.decode(receiver_->bytes());
    if (!has_right_start(receiver_->bytes(), end)) {
      damaged_++;
    } else if ((receiver_->bytes()[kTypeAt] & kReply) == 0) {  // otherwise it is an echo
      const uint8_t payload_end = kMaySeal ? open_seal(end) : end;
      if (payload_end == 0) {
        damaged_++;  // forged, or sealed before another one
      } else {
        if (!has_seal() || is_sealed()) left_ms_[kListen] = kListenMs;
        console_.hang_up();
        handle(payload_end);
        due_ |= kDueReply;
        if (kMaySeal) close_seal();
      }
    }
  }
  is_ready_ = false;
  receiver_->release();
}

// Whether a frame is the successor of the last numbered one.
bool Link::is_next(uint8_t seq, uint8_t epoch) const {
  if (is_sealed()) return is_open_ && epoch == epoch_;  // its counter has risen
  return is_open_ && epoch == epoch_ && static_cast<int8_t>(seq - last_reply_.seq) > 0;
}

// Determines the answer to the frame whose payload ends at `end`.
tini_noinline void Link::handle(uint8_t end) {
  const uint8_t* const bytes = receiver_->bytes();
  const bool is_marked = may_seal() && (bytes[kTypeAt] & kSealed) != 0;
  const uint8_t type = is_marked ? bytes[kTypeAt] & static_cast<uint8_t>(~kSealed) : bytes[kTypeAt];
  const uint8_t seq = bytes[kSeqAt];
  const uint8_t epoch = bytes[kEpochAt];
  const uint8_t payload_start = is_marked ? kSealedPayloadAt : payload_at(end);
  const uint8_t* const payload = bytes + payload_start;
  const uint8_t length = static_cast<uint8_t>(end - payload_start);
  const bool is_hello = type == static_cast<uint8_t>(Message::kHello);

  Reply& last_reply = this->last_reply();
  uint8_t& last_epoch = this->last_epoch();
  const bool is_last = seq == last_reply.seq && type == last_reply.number && epoch == last_epoch;
  const bool is_repeat = is_last && is_marked == is_sealed();
  if (is_open_ && is_repeat && !is_hello && type != static_cast<uint8_t>(Message::kStop)) {
    reply_ = last_reply;
    left_ms_[kFrameSent] = 0;  // it is repeated
    return;
  }
  reply_.number = type & static_cast<uint8_t>(~kSealed);
  reply_.seq = seq;
  reply_.detail = 0;
  const bool is_next = this->is_next(seq, epoch);
  Answer refusal = Answer::kOk;
  if ((type & kSealed) != 0) {
    refusal = Answer::kNotSealed;
  } else if (is_marked && (is_hello || type == static_cast<uint8_t>(Message::kAuthenticate))) {
    refusal = Answer::kNotSealed;  // a seal begins with them
  } else if (is_marked && !is_sealed()) {
    if (type == static_cast<uint8_t>(Message::kStop)) stop(Cause::kMessage);
    refusal = Answer::kNotOwner;
  } else if (type == 0 || type > kLastRequest) {
    refusal = Answer::kUnknownMessage;
  } else if (is_hello && length != 0 && payload[kHelloMajorAt] != kLinkMajor) {
    reply_.detail = kLinkMajor;
    left_ms_[kFrameSent] = 0;
    refusal = Answer::kOtherLink;
  } else if (length < flash_byte(&kRequestBytes[type - 1][0]) ||
             length > flash_byte(&kRequestBytes[type - 1][1])) {
    const bool is_known = flash_byte(&kRequestBytes[type - 1][0]) != kUnknownRequest;
    refusal = is_known ? Answer::kBadLength : Answer::kUnknownMessage;
  } else if (type >= kFirstActing && !is_next) {
    refusal = Answer::kStale;
  } else if (is_forbidden(type)) {
    refusal = Answer::kNotOwner;
  } else {
    refusal = may_drive(type);
  }
  reply_.status = number_of(refusal);
  if (refusal == Answer::kOk) {
    if (type >= kFirstActing && (!kHasRemote || type != static_cast<uint8_t>(Message::kKeys))) {
      console_.drop();  // it may use the same memory
    }
    reply_.status = answer(static_cast<Message>(type), payload, length);
  }
  if ((is_next && (!kMaySeal || keeps_answer(type))) || (is_hello && reply_.status == kOkStatus)) {
    last_reply = reply_;
    last_epoch = epoch;
  }
}

uint8_t Link::answer(Message message, const uint8_t* payload, uint8_t length) {
  Answer answer = Answer::kOk;
  switch (message) {
    case Message::kHello:
      return hello(payload);
    case Message::kWifi:
      if (!kHasTransports) break;
      return set_wifi(payload, length);
    case Message::kKeys:
      if (!kHasRemote) break;
      answer = hold(*reinterpret_cast<const RemoteKeys*>(payload));
      if (answer == Answer::kOk) reply_.detail = length;
      break;
    case Message::kPing:
      reply_.detail = length;
      break;
    case Message::kBreak:
      if (kHasBreakpoints) answer = set_breakpoints(payload, length);
      break;
    case Message::kResume:
      if (kHasBreakpoints) answer = resume(payload[kResumeHowAt]);
      break;
    case Message::kReadVariables:
      if (!kHasBreakpoints) break;
      reply_.detail = payload[kReadVariablesFirstAt];
      if (reply_.detail >= kVariables) answer = Answer::kBadValue;
      break;
    case Message::kTellReadings:
      if (kTellsReadings) tell_readings(payload[kTellReadingsIsOnAt] != 0);
      break;
    case Message::kReadTasks:
    case Message::kHalted:
    case Message::kReading:
    case Message::kStatus:
    case Message::kShow:
    case Message::kFault:
    case Message::kStopped:
    case Message::kDone:
      break;
    case Message::kFetch:
      answer = missing_program_answer();
      if (answer == Answer::kOk) reply_.detail = get16(payload + kFetchOffsetAt);
      break;
    case Message::kStop:
      stop(Cause::kMessage);
      if (kHasOwners && is_authorized(is_teacher())) rights_ |= kHeldBack;
      break;
    case Message::kClear:
      answer = clear();
      break;
    case Message::kStart:
      if ((payload[kStartModeAt] & ~kDetached) != 0) {
        answer = Answer::kBadValue;
      } else if ((answer = missing_program_answer()) != Answer::kOk) {
        break;
      } else if (port_is_latched()) {
        answer = Answer::kLatched;
      } else if ((answer = port_prepare_upload(true)) == Answer::kOk) {
        image_ = nullptr;
        checksum_ = port_status().program;
        start(payload[kStartModeAt], false);
      }
      break;
    case Message::kLive:
    case Message::kProgram:
      return take_short(message == Message::kLive, payload, length);
    case Message::kBegin:
      return begin_program(payload);
    case Message::kData:
      return add_data(payload, length);
    case Message::kCommit:
      return commit(payload);
    case Message::kAbort:
      image_ = nullptr;
      break;
    case Message::kName:
      answer = port_rename(payload, length);
      break;
    case Message::kTrim:
      if (length != 0) answer = set_trim(payload, length);
      break;
    case Message::kClaim:
      answer = kHasOwners ? claim(payload, length) : Answer::kUnknownMessage;
      break;
    case Message::kAuthenticate:
      return kHasOwners ? authenticate(payload, length) : number_of(Answer::kUnknownMessage);
    case Message::kIdentify:
      port_identify();
      break;
    case Message::kUndo:
      image_ = nullptr;
      answer = port_undo();
      checksum_ = port_status().program;
      break;
    case Message::kText:
      answer = kHasOwners ? allow_text(payload) : Answer::kUnknownMessage;
      break;
  }
  return number_of(answer);
}

Answer Link::clear() {
  if ((rights_ & kHeldBack) != 0 && !is_authorized(is_teacher())) return Answer::kHeldBack;
  rights_ &= static_cast<uint8_t>(~kHeldBack);
  port_release();
  return Answer::kOk;
}

Answer Link::set_trim(const uint8_t* payload, uint8_t length) {
  const bool has_pace = length == sizeof(Tuning);
  if (!has_pace && length != sizeof(Trim)) return Answer::kBadLength;
  return port_tune(*reinterpret_cast<const Tuning*>(payload), has_pace);
}

// The newest word of a remote control counts, until kHoldMs are over.
Answer Link::hold(const RemoteKeys& remote_keys) {
  if (!kHasRemote) return Answer::kOk;
  if (remote_keys.keys >= 1 << kRemoteKeys) return Answer::kBadValue;
  const int8_t* axis = remote_keys.pad;
  do {
    if (static_cast<uint8_t>(*axis + kMaxPad) > 2 * kMaxPad) return Answer::kBadValue;
  } while (++axis != remote_keys.pad + 2);
  remote_ = remote_keys;
  left_ms_[kHold] = kHoldMs;
  return Answer::kOk;
}

uint8_t Link::hello(const uint8_t* payload) {
  const bool is_new = !is_open_ || !same_bytes(&nonce_, payload + kHelloNonceAt);
  left_ms_[kFrameSent] = 0;  // this client may not have heard a frame before
  if (is_new) {
    renew();
    if (kHasBreakpoints) forget_breakpoints();
    if (kTellsReadings) forget_readings();
  }
  if (is_new || may_seal()) expire();
  if (is_new) forget_answer();
  is_open_ = true;
  copy_bytes(payload + kHelloNonceAt, reinterpret_cast<uint8_t*>(&nonce_), sizeof nonce_);
  isa_[0] = payload[kHelloIsaMajorAt];
  isa_[1] = payload[kHelloIsaMinorAt];
  is_other_kit_ = get16(payload + kHelloKitAt) != port_identity().kit;
  return kOkStatus;
}

// Everything sent before is now stale, and so is a program in transfer.
void Link::renew() {
  epoch_++;
  image_ = nullptr;
}

}  // namespace tiniscript
