// Asserts that a reader lies in memory as `reader_avr.h` tells the assembly, and has its numbers.

#include "reader_avr.h"
#include "reader_parts.h"

#ifdef __AVR__

#include <stddef.h>

namespace tiniscript {

struct Reader::Layout {
  static_assert(offsetof(Reader, buffer_) == tini_buffer_at, "");
  static_assert(offsetof(Reader, stack_) == tini_waiting_at, "");
  static_assert(offsetof(Reader, length_) == tini_code_length_at, "");
  static_assert(offsetof(Reader, problem_) == tini_problem_at, "");
  static_assert(offsetof(Reader, value_) == tini_value_at, "");
};

static_assert(static_cast<uint8_t>(Problem::kFull) == tini_problem_full, "");
static_assert(kShorts == tini_shorts, "");
static_assert(byte_of(Op::kPushNum0) == tini_push_num_0, "");
static_assert(byte_of(Op::kPush8) == tini_push_8, "");
static_assert(byte_of(Op::kPush16) == tini_push_16, "");
static_assert(byte_of(Op::kPush32) == tini_push_32, "");
static_assert(byte_of(Op::kPushTenths) == tini_push_tenths, "");
static_assert(byte_of(Op::kPushMilli) == tini_push_milli, "");

}  // namespace tiniscript

#endif
