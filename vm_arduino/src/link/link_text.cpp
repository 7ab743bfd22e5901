// The link of a robot that reads text: does what a line asks for, and answers with lines.

#include "reads_text.h"

#ifdef tiniscript_reads_text

#include "../vm/bytecode.h"
#include "../vm/small.h"
#include "../vm/verify.h"
#include "../vm/vm.h"
#include "link.h"
#include "port.h"

namespace tiniscript {

// Does what a line asks for.
tini_noinline void Link::talk() {
  const Console::Act act = console_.turn(receiver_, is_listened_to());
  if (act == Console::Act::kStop) halt(Cause::kText);
  if (act == Console::Act::kEnd) port_end();
  if (act == Console::Act::kStart) {
    is_ready_ = false;  // its image may lie where the one of a frame was made ahead
    console_.say(start_text());
  }
  if (console_.has_answer()) due_ |= kDueText;
}

// Starts the program that was read. Returns what to say.
Remark Link::start_text() {
  if (!text_may_drive()) return Remark::kNotOwner;
  const Reader& reader = console_.reader();
  const uint8_t start = reader.start();
  if (start == 0 && port_status().state >= State::kStopped) {
    if ((rights_ & kHeldBack) != 0) return Remark::kHeldBack;
    if (!reader.has_setup()) return Remark::kLatched;
    port_release();
  }
  uint8_t* image = console_.image();
  uint8_t* const code = image + kHeaderBytes;
  const uint8_t length = reader.length();
  uint16_t devices;
  const DeviceInfo& device_info = port_device_info();
  const Verdict verdict =
      verify(code, length, device_info.sensors, device_info.actuators, &devices);
  if (verdict.rule != Rule::kNone) return Remark::kRefused;
  const uint8_t header[] = {'T', 'S', kIsaMajor, kIsaMinor, start, kHeaderBytes};
  copy_bytes(header, image, sizeof header);
  image[kDevicesAt] = static_cast<uint8_t>(devices);
  image[kDevicesAt + 1] = static_cast<uint8_t>(devices >> 8);
  image[kCodeLengthAt] = length;
  image[kCodeLengthAt + 1] = 0;
  image[kNeedsAt] = kNeeds;
  for (uint8_t k = 0; k < kEndBytes; k++) code[length + k] = static_cast<uint8_t>(Op::kEnd);
  image_ = nullptr;
  seal();  // a frame's image of this turn, whose receipt is due
  const uint32_t receipt = checksum_;
  image = port_take_text(start != 0);
  if (image == nullptr) return Remark::kSaving;
  put_checksum(image);
  port_seal(image);
  checksum_ = receipt;
  is_tethered_ = false;
  if (start != 0) return Remark::kOkButton;
  return console_.has_lost() ? Remark::kOkLost : Remark::kOk;
}

// Sends a line of an answer; to a person, what has happened as well.
void Link::send_text() {
  if (!console_.has_answer()) {
    if ((due_ & kDueStopped) != 0) {
      console_.say(Remark::kStopped);
    } else {
      console_.say((due_ & kDueFault) != 0 ? Remark::kFault : Remark::kDone);
    }
    due_ = kDueText;
  }
  size_ = console_.write(out_);
  if (!console_.has_answer()) due_ &= static_cast<uint8_t>(~kDueText);
  is_after_text_ = true;
  hand_over();
}

void Link::show_text(int32_t value, bool is_yes_no) {
  size_ = Console::write_value(value, is_yes_no, out_);
  is_after_text_ = true;
  hand_over();
}

// Sends the 0x00 that stands between text and a frame. False: none is needed.
bool Link::separate() {
  if (!is_after_text_) return false;
  is_after_text_ = false;
  size_ = 0;
  put(0);
  hand_over();
  return true;
}

}  // namespace tiniscript

#endif  // tiniscript_reads_text
