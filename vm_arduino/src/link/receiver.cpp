#include "receiver.h"

#include "../vm/small.h"

namespace tiniscript {

namespace {

bool is_letter(uint8_t byte) {
  const uint8_t small = static_cast<uint8_t>(byte | 0x20);
  return small >= 'a' && small <= 'z';
}

bool ends_line(uint8_t byte) { return byte == '\r' || byte == '\n'; }

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
  if (place_ == Place::kAfterText && (byte == ' ' || byte == '\t' || ends_line(byte))) return false;
  if (place_ <= Place::kAfterText) begin(byte);
  if (place_ == Place::kFrame) {
    if (length_ == kItemBytes && !is_dropping_) {
      damaged_ = static_cast<uint8_t>(damaged_ + 1);
      place_ = Place::kSkip;
    } else {
      add(byte);
    }
  } else if (place_ == Place::kText) {
    if (ends_line(byte)) {
      end(Item::kText);
      place_ = Place::kAfterText;
    } else {
      add(byte);
    }
  }
  return false;
}

void Receiver::begin(uint8_t byte) {
  is_dropping_ = item_ != Item::kNone;
  if (byte >= kTextFrom && !is_letter(byte)) {
    damaged_ = static_cast<uint8_t>(damaged_ + 1);
    place_ = Place::kSkip;
    return;
  }
  place_ = byte < kTextFrom ? Place::kFrame : Place::kText;
  if (is_dropping_) {
    dropped_ = static_cast<uint8_t>(dropped_ + 1);
  } else {
    length_ = 0;
  }
}

// What waits, and its length, stay as they are.
void Receiver::add(uint8_t byte) {
  if (is_dropping_) return;
  if (length_ < kItemBytes) bytes_[length_] = byte;
  if (length_ < 255) length_++;
}

bool Receiver::zero() {
  if (place_ == Place::kFrame) {
    end(Item::kFrame);
    place_ = Place::kBegin;
  } else {
    cut();
  }
  if (zeros_ > kStopRun) return false;
  if (++zeros_ != kStopRun) return false;
  stops_ = static_cast<uint8_t>(stops_ + 1);
  return true;
}

// Begins anew; what is open has no end of its own.
void Receiver::cut() {
  if (place_ == Place::kFrame || place_ == Place::kText) {
    damaged_ = static_cast<uint8_t>(damaged_ + 1);
  }
  place_ = Place::kBegin;
}

void Receiver::end(Item item) {
  if (!is_dropping_) item_ = item;
}

}  // namespace tiniscript
