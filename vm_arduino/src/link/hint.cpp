#include "reads_text.h"

#ifndef tiniscript_reads_text

#include "hint.h"

#include "../vm/flash.h"
#include "../vm/small.h"
#include "frames.h"

namespace tiniscript {

namespace {

// Its 0x00 ends the item, so that a frame may follow.
const uint8_t kHint[] tini_progmem = "No text here: use tsc. / Aqui no hay texto: usa tsc.\r\n";
constexpr uint8_t kTailBytes = 8;  // its end, which identifies an echo

static_assert(sizeof kHint <= kWireBytes, "it is sent like a frame");

// Whether the line ends like the hint, or is the end of the hint.
bool is_own(const uint8_t* bytes, uint8_t length) {
  const uint8_t* hint = kHint + sizeof kHint - 3;  // without CR, LF and 0x00
  for (uint8_t k = 0; k < kTailBytes && length != 0; k++) {
    if (bytes[--length] != flash_byte(--hint)) return false;
  }
  return true;
}

}  // namespace

Hint::Act Hint::turn(Receiver* receiver, bool is_heard) {
  if (receiver->has_line()) {
    if (left_ms_ == 0 && !is_heard && !is_own(receiver->bytes(), receiver->length())) {
      is_due_ = true;
    }
    left_ms_ = kListenMs;
    receiver->release();
  }
  return Act::kNone;
}

uint8_t Hint::write(uint8_t* out) {
  is_due_ = false;
  for (const uint8_t& byte : kHint) *out++ = flash_byte(&byte);
  return sizeof kHint;
}

}  // namespace tiniscript

#endif  // tiniscript_reads_text
