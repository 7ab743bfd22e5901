#include "link.h"

#include "../vm/crc32.h"
#include "../vm/image.h"
#include "../vm/small.h"
#include "../vm/verify.h"
#include "../vm/vm.h"
#include "port.h"

namespace tiniscript {

namespace {

constexpr uint16_t kIsa = kIsaMajor << 8 | kIsaMinor;
constexpr uint8_t kFirstAt = kIsaMajorAt;  // of what BEGIN brings of a header
constexpr uint8_t kIsFine = static_cast<uint8_t>(Answer::kOk);

uint8_t number_of(Answer answer) { return static_cast<uint8_t>(answer); }

bool is_latched() { return port_condition().state >= State::kStopped; }

bool holds_nothing() { return port_condition().saved == Saved::kNothing; }

bool may_start(uint8_t mode) { return (mode & (kRun | kStartBits)) != kRun || !is_latched(); }

tini_noinline Verdict verified(const uint8_t* code, uint16_t length) {
  const Equipment& equipment = port_equipment();
  return verify(code, length, equipment.sensors, equipment.actuators);
}

}  // namespace

void Link::begin(Receiver* receiver, uint8_t epoch) {
  receiver_ = receiver;
  epoch_ = epoch;
}

void Link::tick(uint16_t now_ms) { near(this)->turn(now_ms); }

void Link::turn(uint16_t now_ms) {
  const uint16_t passed = static_cast<uint16_t>(now_ms - now_ms_);
  now_ms_ = now_ms;
  quiet_ms_ =
      passed < kListenMs - quiet_ms_ ? static_cast<uint16_t>(quiet_ms_ + passed) : kListenMs;
  text_ms_ = passed < text_ms_ ? static_cast<uint16_t>(text_ms_ - passed) : 0;
  again_ms_ = passed < again_ms_ ? static_cast<uint8_t>(again_ms_ - passed) : 0;
  if (stop_is_due()) {
    receiver_->take_stop();  // before it is handled: one that comes meanwhile is another one
    halt(Cause::kSequence);
  }
  // an answer that is due first
  if ((due_ & (kDueReply | kDueHint)) == 0 && receiver_->item() != Item::kNone) hear();
  if (quiet_ms_ >= kTetherMs && is_tethered_ && port_condition().state == State::kRunning) {
    port_stop(static_cast<uint8_t>(LinkFault::kLinkLost));
    faulted();
  }
}

void Link::tell() {
  Link* const self = near(this);
  self->seal();
  if (self->left_ == 0) self->send();
}

tini_noinline void Link::seal() {
  uint8_t* const image = unsealed_;
  if (image == nullptr) return;
  unsealed_ = nullptr;
  put_checksum(image);
  port_seal(image);
}

bool Link::next_tx_byte(uint8_t* byte) {
  if (left_ == 0) return false;
  left_ = static_cast<uint8_t>(left_ - 1);
  *byte = out_[sent_++];
  return true;
}

// Stops the robot. Where it was stopped already, that is told again, but not all the time; the
// epoch stays, or a line that is held low would run it round. What waits is from before the stop.
tini_noinline void Link::halt(Cause cause) {
  const bool was_stopped = port_condition().state == State::kStopped;
  port_stop(0);
  const bool has_stale = cause == Cause::kSequence && receiver_->item() != Item::kNone;
  if (!was_stopped || has_stale) return stopped(cause);
  if (again_ms_ != 0) return;
  again_ms_ = kAgainMs;
  due_ |= kDueStopped;
}

// A line of text is answered where nobody sends frames, no other line has come for a while, and it
// is none of ours: so nothing that answers or echoes each line talks to the robot for ever.
tini_noinline void Link::hear() {
  if (receiver_->item() == Item::kText) {
    if (text_ms_ == 0 && !is_listened_to() && !is_own_hint()) due_ |= kDueHint;
    text_ms_ = kListenMs;
  } else {
    const uint8_t end = decode_frame(receiver_->bytes(), receiver_->length());
    if (end == 0) {
      damaged_++;
    } else if ((receiver_->bytes()[kTypeAt] & kReply) == 0) {  // else it is an echo
      quiet_ms_ = 0;
      handle(end);
      due_ |= kDueReply;
    }
  }
  receiver_->release();
}

// Finds out what is answered to the frame whose payload ends at `end`.
tini_noinline void Link::handle(uint8_t end) {
  const uint8_t* const bytes = receiver_->bytes();
  const uint8_t type = bytes[kTypeAt];
  const uint8_t seq = bytes[kSeqAt];
  const uint8_t epoch = bytes[kEpochAt];
  const uint8_t* const payload = bytes + kPayloadAt;
  const uint8_t length = static_cast<uint8_t>(end - kPayloadAt);
  const bool is_hello = type == static_cast<uint8_t>(Message::kHello);

  const bool is_known = seq == last_.seq && type == last_.number && epoch == last_epoch_;
  if (is_open_ && is_known && !is_hello && type != static_cast<uint8_t>(Message::kStop)) {
    said_ = last_;
    return;
  }
  said_.number = type & static_cast<uint8_t>(~kSealed);
  said_.seq = seq;
  said_.detail = 0;
  const bool is_next = is_open_ && epoch == epoch_ && static_cast<int8_t>(seq - last_.seq) > 0;
  Answer refusal = Answer::kOk;
  if ((type & kSealed) != 0) {
    refusal = Answer::kNotSealed;
  } else if (type == 0 || type > kLastRequest) {
    refusal = Answer::kUnknownMessage;
  } else if (is_hello && length != 0 && payload[kHelloMajorAt] != kLinkMajor) {
    said_.detail = kLinkMajor;
    refusal = Answer::kOtherLink;
  } else if (length < flash_byte(&kRequestBytes[type - 1][0]) ||
             length > flash_byte(&kRequestBytes[type - 1][1])) {
    refusal = Answer::kBadLength;
  } else if (type >= kFirstActing && !is_next) {
    refusal = Answer::kStale;
  }
  said_.status = number_of(refusal);
  if (refusal == Answer::kOk) {
    said_.status = answer(static_cast<Message>(type), payload, length);
  }
  if (is_next || (is_hello && said_.status == kIsFine)) {
    last_ = said_;
    last_epoch_ = epoch;
  }
}

uint8_t Link::answer(Message message, const uint8_t* payload, uint8_t length) {
  Answer found = Answer::kOk;
  switch (message) {
    case Message::kHello:
      return hello(payload);
    case Message::kPing:
    case Message::kStatus:
    case Message::kShow:
    case Message::kFault:
    case Message::kStopped:
    case Message::kDone:
      break;
    case Message::kFetch:
      said_.detail = get16(payload + kFetchOffsetAt);
      if (holds_nothing()) found = Answer::kNoProgram;
      break;
    case Message::kStop:
      halt(Cause::kMessage);
      break;
    case Message::kClear:
      port_release();
      break;
    case Message::kStart:
      if ((payload[kStartModeAt] & ~kDetached) != 0) {
        found = Answer::kBadValue;
      } else if (holds_nothing()) {
        found = Answer::kNoProgram;
      } else if (is_latched()) {
        found = Answer::kLatched;
      } else if ((found = port_make_way(true)) == Answer::kOk) {
        image_ = nullptr;
        checksum_ = port_condition().program;
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
      found = port_rename(payload, length);
      break;
    case Message::kTrim:
      if (length != 0) found = set_trim(payload, length);
      break;
  }
  return number_of(found);
}

Answer Link::set_trim(const uint8_t* payload, uint8_t length) {
  Trim trim;
  if (length != sizeof trim) return Answer::kBadLength;
  copy_bytes(payload, reinterpret_cast<uint8_t*>(&trim), sizeof trim);
  return port_set_trim(trim);
}

uint8_t Link::hello(const uint8_t* payload) {
  if (!is_open_ || !same_bytes(&nonce_, payload + kHelloNonceAt)) renew();
  is_open_ = true;
  copy_bytes(payload + kHelloNonceAt, reinterpret_cast<uint8_t*>(&nonce_), sizeof nonce_);
  isa_[0] = payload[kHelloIsaMajorAt];
  isa_[1] = payload[kHelloIsaMinorAt];
  is_other_kit_ = get16(payload + kHelloKitAt) != port_card().kit;
  return kIsFine;
}

// What was sent before is stale from now on, and so is the program on its way.
void Link::renew() {
  epoch_++;
  image_ = nullptr;
}

// Says why not, and a number that belongs to it.
uint8_t Link::refuse(Answer answer, uint16_t detail) {
  said_.detail = detail;
  return number_of(answer);
}

// Whether the robot may take a program at all. `header` is that of its image, from the instruction
// set on.
uint8_t Link::check(uint8_t mode, const uint8_t* header) {
  if (header[kIsaMajorAt - kFirstAt] != kIsaMajor || header[kIsaMinorAt - kFirstAt] > kIsaMinor) {
    return refuse(Answer::kOtherMachine, kIsa);
  }
  const uint8_t start_mode = mode & kStartBits;
  if (header[kNeedsAt - kFirstAt] != 0 || header[kStartAt - kFirstAt] != start_mode ||
      start_mode >= kStartPing || (mode & ~(kStartBits | kRun | kSave | kDetached)) != 0) {
    return refuse(Answer::kBadValue, 0);
  }
  const uint16_t kit = get16(header + kKitAt - kFirstAt);
  if (kit != 0 && kit != port_card().kit) return refuse(Answer::kWrongKit, port_card().kit);
  if (!may_start(mode)) return refuse(Answer::kLatched, 0);
  return kIsFine;
}

// Begins an image. Where it is refused, nothing of the one before is lost.
uint8_t Link::make_room(uint8_t mode, const uint8_t* header, bool is_live) {
  const uint16_t length = get16(header + kCodeLengthAt - kFirstAt);
  uint8_t* const image = port_memory(length, is_live);
  if (image == nullptr) return refuse(Answer::kTooLarge, port_room());
  const Answer way = port_make_way(is_live);
  if (way != Answer::kOk) return refuse(way, 0);
  image_ = image;
  mode_ = mode;
  length_ = length;
  next_ = 0;
  image[kMagicAt] = 'T';
  image[kMagicAt + 1] = 'S';
  copy_bytes(header, image + kFirstAt, kChecksumAt - kFirstAt);
  uint8_t* const end = image + kHeaderBytes + length;
  for (uint8_t k = 0; k < kEndBytes; k++) end[k] = static_cast<uint8_t>(Op::kEnd);
  return kIsFine;
}

void Link::append(const uint8_t* code, uint8_t length) {
  copy_bytes(code, image_ + kHeaderBytes + next_, length);
  next_ = static_cast<uint16_t>(next_ + length);
}

// A whole program in one frame.
tini_noinline uint8_t Link::take_short(bool is_live, const uint8_t* payload, uint8_t length) {
  const uint8_t mode = payload[kProgramModeAt];
  const uint8_t* const code = payload + kProgramCodeAt;
  length = static_cast<uint8_t>(length - kProgramCodeAt);
  if (is_live && mode != kRun) return refuse(Answer::kBadValue, 0);
  uint8_t header[kChecksumAt - kFirstAt] = {
      isa_[0], isa_[1], static_cast<uint8_t>(mode & kStartBits), 0, 0, 0, length, 0};
  const uint8_t refusal = check(mode, header);
  if (refusal != kIsFine) return refusal;

  // what needs no device is for any kit
  Verdict verdict = verify(code, length, 0, 0);
  if (verdict.rule == Rule::kNoSuchDevice) {
    const uint16_t kit = port_card().kit;
    if (is_other_kit_) return refuse(Answer::kWrongKit, kit);
    header[kKitAt - kFirstAt] = static_cast<uint8_t>(kit);
    header[kKitAt - kFirstAt + 1] = static_cast<uint8_t>(kit >> 8);
    verdict = verified(code, length);
  }
  if (verdict.rule != Rule::kNone) return refuse(static_cast<Answer>(verdict.rule), verdict.offset);
  const uint8_t found = make_room(mode, header, is_live);
  if (found != kIsFine) return found;
  append(code, length);
  unsealed_ = image_;
  finish(is_live);
  return kIsFine;
}

uint8_t Link::begin_program(const uint8_t* payload) {
  const uint8_t mode = payload[kBeginModeAt];
  const uint8_t* const header = payload + kBeginIsaMajorAt;
  uint8_t refusal = check(mode, header);
  if (refusal == kIsFine) refusal = make_room(mode, header, false);
  if (refusal == kIsFine) port_forget();
  return refusal;
}

uint8_t Link::add_data(const uint8_t* payload, uint8_t length) {
  length = static_cast<uint8_t>(length - kDataCodeAt);
  if (image_ == nullptr) return refuse(Answer::kNotBegun, 0);
  if (get16(payload + kDataOffsetAt) != next_) return kIsFine;  // the reply says where it goes on
  if (length > length_ - next_) return refuse(Answer::kBadLength, 0);
  append(payload + kDataCodeAt, length);
  return kIsFine;
}

uint8_t Link::commit(const uint8_t* payload) {
  uint8_t* const image = image_;
  if (image == nullptr) return refuse(Answer::kNotBegun, 0);
  if (next_ != length_) return refuse(Answer::kIncomplete, next_);
  image_ = nullptr;
  put_checksum(image);
  if (!same_bytes(&checksum_, payload + kCommitChecksumAt)) {
    return static_cast<uint8_t>(Refusal::kDamaged);
  }
  // what is for no kit has no device
  const uint8_t* const code = image + kHeaderBytes;
  const Verdict verdict =
      get16(image + kKitAt) == 0 ? verify(code, length_, 0, 0) : verified(code, length_);
  if (verdict.rule != Rule::kNone) return refuse(static_cast<Answer>(verdict.rule), verdict.offset);
  finish(false);
  port_seal(image);
  return kIsFine;
}

// Puts the checksum into the image, which has all the rest.
void Link::put_checksum(uint8_t* image) {
  checksum_ = crc32(crc32(0, image, kChecksumAt), image + kHeaderBytes, length_);
  copy_bytes(&checksum_, image + kChecksumAt, sizeof checksum_);
}

// The image in memory is verified, and whole but for its checksum.
void Link::finish(bool is_live) {
  image_ = nullptr;
  port_take(mode_, is_live);
  if ((mode_ & (kRun | kStartBits)) == kRun) start(mode_, is_live);
}

void Link::start(uint8_t mode, bool is_live) {
  port_start(is_live);
  is_tethered_ = (mode & kDetached) == 0;
}

}  // namespace tiniscript
