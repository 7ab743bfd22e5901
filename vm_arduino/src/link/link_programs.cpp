// Program transfer: the link checks, verifies, stores and starts a program.
//
// A program that runs once is prepared before its frame has ended, so that it starts at once.

#include "../vm/image.h"
#include "../vm/machine.h"
#include "../vm/small.h"
#include "../vm/verify.h"
#include "link.h"
#include "port.h"

namespace tiniscript {

namespace {

constexpr uint16_t kIsa = kIsaMajor << 8 | kIsaMinor;
constexpr uint8_t kFirstAt = kIsaMajorAt;  // first header byte that BEGIN carries
constexpr uint8_t kLiveByte = static_cast<uint8_t>(Message::kLive);

bool may_start(uint8_t mode) { return (mode & (kRun | kStartBits)) != kRun || !port_is_latched(); }

}  // namespace

// Called when the payload of a frame has arrived, assuming that the frame ends at the next zero.
// Makes and verifies the image of LIVE. No report and no start happens yet, because the frame may
// turn out to be damaged or longer.
tini_noinline void Link::make_ahead() {
  uint8_t* const bytes = receiver_->bytes();
  const uint8_t end = check_.decode(bytes);  // of too few bytes it wraps around, and is very large
  const uint8_t start = payload_at(end);
  if (end == ahead_end_ || end <= start || end > kLargestFrame || bytes[kTypeAt] != kLiveByte ||
      (is_large(end) && bytes[kPayloadAt] != 0) || due_ != 0 || !is_open_ ||
      is_forbidden(kLiveByte) || console_.is_open() || !port_may_write_ahead()) {
    return;
  }
  ahead_end_ = end;
  is_ready_ = fill(Use::kAhead, bytes + start, static_cast<uint8_t>(end - start)) == kOkStatus;
}

// Runs the image that was made ahead. False: this frame does not allow it.
bool Link::go_live() {
  const uint8_t* const bytes = receiver_->bytes();
  if (!check_.is_whole() || !is_next(bytes[kSeqAt], bytes[kEpochAt]) || port_is_latched() ||
      may_drive(kLiveByte) != Answer::kOk || port_prepare_upload(true) != Answer::kOk) {
    return false;
  }
  left_ms_[kListen] = kListenMs;
  // Both at once, and no detail: that is quicker than to copy it.
  reply_.number = last_reply_.number = kLiveByte;
  reply_.seq = last_reply_.seq = bytes[kSeqAt];
  reply_.status = last_reply_.status = kOkStatus;
  last_epoch_ = epoch_;
  image_without_checksum_ = last_image_;
  finish(kRun, true);
  return true;
}

// Refuses, with a reason and its detail.
tini_noinline uint8_t Link::refuse(Answer answer, uint16_t detail) {
  reply_.detail = detail;
  return number_of(answer);
}

// Whether the robot may take a program of this instruction set at all.
uint8_t Link::allow(uint8_t mode, const uint8_t* isa) {
  if (isa[0] != kIsaMajor || isa[1] > kIsaMinor) return refuse(Answer::kOtherMachine, kIsa);
  if ((mode & kStartBits) >= kStartPing ||
      (mode & ~(kStartBits | kRun | kSave | kDetached)) != 0) {
    return refuse(Answer::kBadValue, 0);
  }
  if (!may_start(mode)) return refuse(Answer::kLatched, 0);
  return kOkStatus;
}

// Begins an image of this length; the rest of its header is missing. A refusal leaves the image
// before intact.
uint8_t Link::make_room(Use use, uint16_t length) {
  const bool is_live = use != Use::kStored;
  uint8_t* const image = port_memory(length, is_live);
  if (image == nullptr) return refuse(Answer::kTooLarge, port_room());
  if (use != Use::kAhead) {
    const Answer answer = port_prepare_upload(is_live);
    if (answer != Answer::kOk) return refuse(answer, 0);
  }
  last_image_ = image;
  drop_ahead();
  image[kMagicAt] = 'T';
  image[kMagicAt + 1] = 'S';
  uint8_t* const end = image + length;
  for (uint8_t k = 0; k < kEndBytes; k++) end[k] = static_cast<uint8_t>(Op::kEnd);
  return kOkStatus;
}

// Makes and verifies an image from the payload of LIVE or PROGRAM.
uint8_t Link::fill(Use use, const uint8_t* payload, uint8_t length) {
  uint8_t mode = payload[kProgramModeAt];
  if (kHasBreakpoints && use == Use::kLive) mode &= static_cast<uint8_t>(~kHalts);
  if (use != Use::kStored && mode != kRun) return refuse(Answer::kBadValue, 0);
  const uint8_t refusal = allow(mode, isa_);
  if (refusal != kOkStatus) return refusal;
  return make(use, mode & kStartBits, payload + kProgramCodeAt,
              static_cast<uint8_t>(length - kProgramCodeAt), is_other_kit_);
}

// Verifies code and makes its image. A program that needs no device fits any kit.
tini_noinline uint8_t Link::make(Use use, uint8_t start, const uint8_t* code, uint8_t length,
                                 bool is_other_kit) {
  uint16_t devices;
  const uint8_t sensors = is_other_kit ? 0 : port_readings();
  const uint8_t actuators = is_other_kit ? 0 : port_actuators();
  const Verdict verdict = verify(code, length, sensors, actuators, &devices, kNeeds);
  if (verdict.rule == Rule::kNoSuchDevice && is_other_kit) {
    return refuse(Answer::kWrongKit, port_identity().kit);
  }
  if (!verdict.is_accepted()) {
    return refuse(static_cast<Answer>(verdict.rule), verdict.offset());
  }
  const uint8_t refusal = make_room(use, static_cast<uint16_t>(kHeaderBytes + length));
  if (refusal != kOkStatus) return refusal;
  uint8_t* const image = last_image_;
  image[kIsaMajorAt] = kIsaMajor;
  image[kIsaMinorAt] = verdict.minor();
  image[kStartAt] = start;
  image[kHeaderLengthAt] = kHeaderBytes;
  image[kDevicesAt] = static_cast<uint8_t>(devices);
  image[kDevicesAt + 1] = static_cast<uint8_t>(devices >> 8);
  image[kCodeLengthAt] = length;
  image[kCodeLengthAt + 1] = 0;
  image[kNeedsAt] = verdict.needs();
  copy_bytes(code, image + kHeaderBytes, length);
  return kOkStatus;
}

// Takes a whole program in one frame.
uint8_t Link::take_short(bool is_live, const uint8_t* payload, uint8_t length) {
  const uint8_t refusal = fill(is_live ? Use::kLive : Use::kStored, payload, length);
  if (refusal != kOkStatus) return refusal;
  image_without_checksum_ = last_image_;
  const uint8_t mode = payload[kProgramModeAt];
  finish(mode, is_live);
  if (kHasBreakpoints && is_live && (mode & kHalts) != 0) {
    const uint8_t first_place[] = {0, 0};
    set_breakpoints(first_place, sizeof first_place);
  }
  return kOkStatus;
}

uint8_t Link::begin_program(const uint8_t* payload) {
  const uint8_t mode = payload[kBeginModeAt];
  const uint8_t* const header = payload + kBeginIsaMajorAt;
  uint8_t refusal = allow(mode, header);
  if (refusal != kOkStatus) return refusal;
  if (header[kHeaderLengthAt - kFirstAt] < kHeaderBytes ||
      header[kStartAt - kFirstAt] != (mode & kStartBits)) {
    return refuse(Answer::kBadValue, 0);
  }
  const uint16_t code_length = get16(header + kCodeLengthAt - kFirstAt);
  if (code_length > kCodeBytes) return refuse(Answer::kTooLarge, port_room());
  const uint16_t length = static_cast<uint16_t>(header[kHeaderLengthAt - kFirstAt] + code_length);
  refusal = make_room(Use::kStored, length);
  if (refusal != kOkStatus) return refusal;
  copy_bytes(header, last_image_ + kFirstAt, kChecksumAt - kFirstAt);
  image_ = last_image_;
  mode_ = mode;
  length_ = static_cast<uint16_t>(length - kAfterChecksum);
  next_ = 0;
  port_forget();
  return kOkStatus;
}

uint8_t Link::add_data(const uint8_t* payload, uint8_t length) {
  length = static_cast<uint8_t>(length - kDataBytesAt);
  if (image_ == nullptr) return refuse(Answer::kNotBegun, 0);
  if (get16(payload + kDataOffsetAt) != next_) return kOkStatus;  // the reply says where to continue
  if (length > length_ - next_) return refuse(Answer::kBadLength, 0);
  copy_bytes(payload + kDataBytesAt, image_ + kAfterChecksum + next_, length);
  next_ = static_cast<uint16_t>(next_ + length);
  return kOkStatus;
}

uint8_t Link::commit(const uint8_t* payload) {
  uint8_t* const image = image_;
  if (image == nullptr) return refuse(Answer::kNotBegun, 0);
  if (next_ != length_) return refuse(Answer::kIncomplete, next_);
  image_ = nullptr;
  copy_bytes(payload + kCommitChecksumAt, image + kChecksumAt, kChecksumBytes);
  checksum_ = get32(image + kChecksumAt);
  const Admission admission = admit(image, port_readings(), port_actuators());
  if (admission.refusal == static_cast<uint8_t>(Refusal::kOtherKit)) {
    return refuse(Answer::kWrongKit, port_identity().kit);
  }
  if (admission.refusal != 0) return refuse(static_cast<Answer>(admission.refusal), admission.offset);
  finish(mode_, false);
  port_take_checksum(image);
  return kOkStatus;
}

// The image in memory is verified and complete except for its checksum.
void Link::finish(uint8_t mode, bool is_live) {
  image_ = nullptr;
  note_typed(false);
  port_take(mode, is_live);
  if ((mode & (kRun | kStartBits)) == kRun) start(mode, is_live);
}

void Link::start(uint8_t mode, bool is_live) {
  port_start(is_live);
  is_attached_ = (mode & kDetached) == 0;
  note_run();
}

}  // namespace tiniscript
