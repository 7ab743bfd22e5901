// The link of a robot that reads text: carries out the requests of a line, and answers with lines.

#include "../vm/bytecode.h"
#include "../vm/small.h"
#include "link.h"
#include "port.h"

#ifndef tiniscript_without_text

namespace tiniscript {

// Carries out the requests of a line.
void Link::talk() {
  Console* const console = near(&console_);
  const bool may_say = left_ms_[kFrameSent] == 0;
  const Console::Act act = console->turn(receiver_, is_listened_to(), may_say);
  if (act == Console::Act::kStop) stop(Cause::kText);
  if (act == Console::Act::kEnd) port_end();
  if (act == Console::Act::kStart) console->say(start_text(*console));
  if (kReadsKeys && act == Console::Act::kHold) {
    if (may_press()) hold(console->keys());
    console->note_keys(port_reads_keys(), is_listened_to());
  }
  due_ &= static_cast<uint8_t>(~kDueText);
  if (console->has_answer()) due_ |= kDueText;
}

// A stop has ended typed text, and the answers to it.
void Link::drop_answer() {
  console_.discard();
  due_ &= static_cast<uint8_t>(~kDueText);
}

// Starts the program that was read. Returns the answer.
Remark Link::start_text(const Console& console) {
  if (!text_may_drive()) return Remark::kNotOwner;
  if (may_drive(0) != Answer::kOk) return Remark::kRefused;
  const Reader* const reader = near(&console.reader());
  const uint8_t start = reader->start();
  if (start == 0 && receiver_->has_mark()) return Remark::kNone;
  if (start == 0 && port_status().state >= State::kStopped) {
    if ((rights_ & kHeldBack) != 0) return Remark::kHeldBack;
    if (!reader->has_setup()) return Remark::kLatched;
    port_release();
  }
  const bool is_separate = port_text_is_separate(start != 0);
  if (!port_may_prepare_upload(is_separate)) return Remark::kSaving;
  image_ = nullptr;
  write_checksum();  // an image from a frame in this turn, whose receipt is due
  if (make(is_separate ? Use::kLive : Use::kStored, start, console.image() + kHeaderBytes,
           reader->length(), false) != static_cast<uint8_t>(Answer::kOk)) {
    return Remark::kRefused;
  }
  uint8_t* const image = last_image_;
  port_take_text(image, start != 0);
  image_without_checksum_ = image;  // its first instruction does not wait for the checksum
  note_typed(true);
  is_attached_ = false;
  return start != 0 ? Remark::kOkButton : Remark::kOk;
}

// Sends a line of an answer; to a person, also recent events.
// If frames have arrived, it waits for listeners until they are over.
void Link::send_text() {
  if (left_ms_[kFrameSent] != 0) return;
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
  hand_over();
}

void Link::show_text(int32_t value, bool is_yes_no) {
  size_ = console_.write_value(value, is_yes_no, out_);
  hand_over();
}

}  // namespace tiniscript

#endif
