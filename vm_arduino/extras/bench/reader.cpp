// Reads texts on a simulated ATmega328P: are its programs and problems those of other computers?
//
// The request: the room (2 bytes), the length of the kit's words (2) and these, then texts, each
// with its length (2); 0 ends them. The answer to each: its kind, start or problem, length or
// column, and the CRC-32 of its code.

#include "../../src/text/reader.h"

#include "../../src/text/kit_words.h"
#include "../../src/vm/crc32.h"
#include "../../src/vm/small.h"
#include "../avr/simulated.h"
#include "quiet_robot.h"

using namespace tiniscript;
using simulated::request;
using simulated::say;

namespace {

Reader reader;
uint8_t buffer[1024];
uint16_t words_offset;

}  // namespace

const uint8_t* tiniscript::robot_words() { return simulated::kRequest + words_offset; }
uint16_t tiniscript::robot_language() { return 0; }

int main() {
  simulated::begin();
  const uint16_t room = request.u16();
  const uint16_t words_length = request.u16();
  words_offset = static_cast<uint16_t>(request.place());
  request.skip(words_length);
  Reader* const text_reader = near(&reader);
  for (uint16_t bytes_left = request.u16(); bytes_left != 0; bytes_left = request.u16()) {
    text_reader->begin(buffer, room);
    TextState state = TextState::kNothing;
    for (; bytes_left != 0; bytes_left--) {
      const uint8_t byte = request.u8();
      if (state == TextState::kProblem && text_reader->has_problem())
        continue;  // no later line mends it
      const TextState next_state = text_reader->put(byte);
      if (next_state != TextState::kOpenLine && state != TextState::kProblem) state = next_state;
    }
    const bool is_problem = state == TextState::kProblem;
    say("found", static_cast<uint8_t>(state));
    say("what", is_problem ? static_cast<uint8_t>(text_reader->problem()) : text_reader->start());
    say("how much", is_problem ? text_reader->column() : text_reader->length());
    const uint8_t length = is_problem ? 0 : text_reader->length();
    say("checksum", static_cast<int32_t>(crc32(0, buffer, length)));
  }
  simulated::end();
  return 0;
}
