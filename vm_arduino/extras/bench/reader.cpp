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
uint16_t words_at;

}  // namespace

const uint8_t* tiniscript::robot_words() { return simulated::kRequest + words_at; }
uint16_t tiniscript::robot_language() { return 0; }

int main() {
  simulated::begin();
  const uint16_t room = request.u16();
  const uint16_t words = request.u16();
  words_at = static_cast<uint16_t>(request.place());
  request.skip(words);
  Reader* const its = near(&reader);
  for (uint16_t left = request.u16(); left != 0; left = request.u16()) {
    its->begin(buffer, room);
    TextState state = TextState::kNothing;
    for (; left != 0; left--) {
      const uint8_t byte = request.u8();
      if (state == TextState::kProblem && its->has_problem()) continue;  // no later line mends it
      const TextState next_state = its->put(byte);
      if (next_state != TextState::kOpenLine && state != TextState::kProblem) state = next_state;
    }
    const bool is_problem = state == TextState::kProblem;
    say("found", static_cast<uint8_t>(state));
    say("what", is_problem ? static_cast<uint8_t>(its->problem()) : its->start());
    say("how much", is_problem ? its->column() : its->length());
    const uint8_t length = is_problem ? 0 : its->length();
    say("checksum", static_cast<int32_t>(crc32(0, buffer, length)));
  }
  simulated::end();
  return 0;
}
