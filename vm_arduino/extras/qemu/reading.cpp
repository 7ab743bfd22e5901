#include "reading.h"

#include "../../src/text/kit_words.h"
#include "../../src/text/reader.h"

namespace tiniscript {

namespace {

constexpr uint16_t kMaxRoom = 60000;
constexpr uint16_t kMaxWords = 4096;

uint8_t buffer[kMaxRoom];
uint8_t words[kMaxWords];
Reader reader;

void say(TextState state) {
  if (state == TextState::kOpenBlock) return put(2);
  if (state == TextState::kProblem) {
    put(1);
    put(static_cast<char>(reader.problem()));
    return put(static_cast<char>(reader.column()));
  }
  put(0);
  put(static_cast<char>(reader.start()));
  put(static_cast<char>(reader.length()));
  for (uint8_t k = 0; k < reader.length(); k++) put(static_cast<char>(buffer[k]));
}

// A text ends as a line does.
uint8_t byte_of(size_t text_start, uint32_t length, uint32_t k) {
  return k < length ? request_byte(text_start + k) : uint8_t{'\n'};
}

void read(size_t text_start, uint32_t length, uint16_t room) {
  reader.begin(buffer, room);
  TextState state = TextState::kNothing;
  for (uint32_t k = 0; k <= length; k++) {
    const TextState next_state = reader.put(byte_of(text_start, length, k));
    if (next_state != TextState::kOpenLine) state = next_state;
    if (next_state == TextState::kProblem && reader.has_problem()) break;
  }
  say(state);
}

}  // namespace

void answer_texts(Request request, size_t end) {
  const uint16_t room = request.u16();
  const uint32_t size = request.u32();
  if (room > kMaxRoom || size > kMaxWords) return;
  for (uint32_t k = 0; k < size; k++) words[k] = request.u8();
  while (request.place() < end) {
    const uint32_t length = request.u32();
    read(request.place(), length, room);
    request.skip(length);
  }
}

const uint8_t* robot_words() { return words; }

uint16_t robot_language() { return 0; }

}  // namespace tiniscript
