#include "receiver.h"

#include "../vm/small.h"

namespace tiniscript {

namespace {

bool is_letter(uint8_t byte) {
  const uint8_t small = static_cast<uint8_t>(byte | 0x20);
  return small >= 'a' && small <= 'z';
}

bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

bool is_blank(uint8_t byte) { return byte == ' ' || byte == '\t' || ends_line(byte); }

// In a line of text. Bytes beyond ASCII are UTF-8.
bool is_printable(uint8_t byte) { return byte >= ' ' && byte != 0x7f; }

}  // namespace

bool Receiver::put(uint8_t byte, uint16_t now_ms) { return near(this)->take(byte, now_ms); }

bool Receiver::take(uint8_t byte, uint16_t now_ms) {
  const bool is_quiet = static_cast<uint16_t>(now_ms - last_ms_) >= kSilenceMs;
  last_ms_ = now_ms;
  if (is_quiet) {
    cut();
    zeros_ = 0;
  }
  if (byte == 0) return zero();
  zeros_ = 0;
  if (place_ == Place::kBlank) {
    // The second byte of a request is its type, and no frame to a robot begins like this.
    place_ = is_printable(byte) && byte < 0x80 ? Place::kAfterText : Place::kFrame;
    if (place_ == Place::kFrame) drop();
  }
  if (place_ == Place::kAfterText && is_blank(byte)) return false;
  if (place_ <= Place::kAfterText) {
    begin(byte);
  } else {
    go_on(byte);
  }
  return false;
}

// Determines the kind of an item from its first byte, as far as possible.
void Receiver::begin(uint8_t byte) {
  is_dropping_ = item_ != Item::kNone;
  if (!is_dropping_) {
    length_ = 0;
    has_begun_ = true;
  }
  if (byte == 0x7f) return skip();
  if (is_letter(byte)) {
    place_ = Place::kText;
  } else if (byte >= kTextFrom) {
    place_ = Place::kOther;
  } else if (is_blank(byte)) {
    place_ = Place::kBlank;
  } else {
    place_ = byte > ' ' ? Place::kHead : Place::kFrame;
  }
  if (place_ != Place::kBlank) drop();
  add(byte);
}

// Takes a further byte of an item.
void Receiver::go_on(uint8_t byte) {
  const bool is_text = is_printable(byte) || byte == '\t';
  if (place_ == Place::kSkip) return;
  if (place_ == Place::kHead) {
    place_ = is_printable(byte) ? Place::kLine : Place::kFrame;  // request types are smaller
  } else if (place_ != Place::kFrame && ends_line(byte)) {
    end(Item::kText);
    place_ = Place::kAfterText;
    return;
  } else if (place_ == Place::kLine && !is_text) {
    place_ = Place::kFrame;
  } else if (place_ == Place::kOther && !is_text) {
    return skip();
  }
  if (length_ == kItemBytes && !is_dropping_) {
    if (place_ == Place::kFrame) return skip();
    place_ = Place::kText;
  }
  add(byte);
}

void Receiver::skip() {
  damaged_ = static_cast<uint8_t>(damaged_ + 1);
  place_ = Place::kSkip;
}

// Counts an item that begins while another one waits.
void Receiver::drop() {
  if (is_dropping_) dropped_ = static_cast<uint8_t>(dropped_ + 1);
}

// Leaves a waiting item and its length unchanged.
void Receiver::add(uint8_t byte) {
  if (is_dropping_) return;
  const uint8_t length = length_;
  if (length < kItemBytes) bytes_[length] = byte;
  if (length < 255) length_ = static_cast<uint8_t>(length + 1);
}

bool Receiver::zero() {
  if (place_ >= Place::kBlank && place_ <= Place::kFrame) {
    end(Item::kFrame);
    place_ = Place::kBegin;
  } else {
    cut();
  }
  if (++zeros_ != kStopRun) return false;
  zeros_ = 0;  // four more zeros are another stop
  stop_is_due_ = true;
  return true;
}

// Starts over; the open item never ended.
void Receiver::cut() {
  if (place_ >= Place::kBlank && place_ <= Place::kText) {
    damaged_ = static_cast<uint8_t>(damaged_ + 1);
  }
  place_ = Place::kBegin;
}

void Receiver::end(Item item) {
  if (!is_dropping_) item_ = item;
}

}  // namespace tiniscript
