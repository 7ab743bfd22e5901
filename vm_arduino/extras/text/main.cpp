// Runs the reader of text on a computer, for tests: `text ROOM WORDS [whole]`.
//
// ROOM is the bytes of the reader's buffer, WORDS the table of `kit_words.h` in hexadecimal digits.
// Reads lines from its input, and says of each program in one line `OK start code`, `NO problem
// column` or `MORE`; an empty line begins anew. With `whole`, its input is texts, four bytes of
// length before each, little-endian; each is one program, whatever lines it has.

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <memory>
#include <vector>

#include "../../src/text/kit_words.h"
#include "../../src/text/reader.h"

using namespace tiniscript;

namespace {

std::vector<uint8_t> words;

// An array of its own, so that the sanitizer sees an access outside.
struct SanitizedReader {
  explicit SanitizedReader(size_t bytes) : room(static_cast<uint16_t>(bytes)), buffer(new uint8_t[bytes]) {}

  void begin() { reader.begin(buffer.get(), room); }

  void say(TextState state) const {
    if (state == TextState::kOpenBlock) {
      puts("MORE");
    } else if (state == TextState::kProblem) {
      printf("NO %d %d\n", static_cast<int>(reader.problem()), reader.column());
    } else {
      printf("OK %d ", reader.start());
      for (uint8_t k = 0; k < reader.length(); k++) printf("%02x", buffer[k]);
      putchar('\n');
    }
    fflush(stdout);
  }

  Reader reader = Reader();
  uint16_t room;
  std::unique_ptr<uint8_t[]> buffer;
};

void read_lines(SanitizedReader* sanitized) {
  sanitized->begin();
  bool is_blank = true;
  for (int byte = getchar(); byte >= 0; byte = getchar()) {
    const TextState state = sanitized->reader.put(static_cast<uint8_t>(byte));
    if (state == TextState::kOpenLine) {
      if (byte != '\n') is_blank = false;
      continue;
    }
    if (!is_blank) sanitized->say(state);
    if (is_blank || state != TextState::kOpenBlock) sanitized->begin();
    is_blank = true;
  }
}

void read_texts(SanitizedReader* sanitized) {
  uint8_t head[4];
  while (fread(head, 1, 4, stdin) == 4) {
    std::vector<uint8_t> text(head[0] | head[1] << 8 | head[2] << 16);
    if (fread(text.data(), 1, text.size(), stdin) != text.size()) return;
    if (text.empty() || (text.back() != '\n' && text.back() != '\r')) text.push_back('\n');
    sanitized->begin();
    TextState state = TextState::kNothing;
    for (const uint8_t byte : text) {
      const TextState next_state = sanitized->reader.put(byte);
      if (next_state != TextState::kOpenLine) state = next_state;
      if (next_state == TextState::kProblem && sanitized->reader.has_problem()) break;
    }
    sanitized->say(state);
  }
}

}  // namespace

const uint8_t* tiniscript::robot_words() { return words.data(); }
uint16_t tiniscript::robot_language() { return 0; }

int main(int count, char** arguments) {
  if (count < 3) return 2;
  for (const char* digits = arguments[2]; digits[0] != 0 && digits[1] != 0; digits += 2) {
    const char digit_pair[] = {digits[0], digits[1], 0};
    words.push_back(static_cast<uint8_t>(strtol(digit_pair, nullptr, 16)));
  }
  SanitizedReader sanitized(static_cast<size_t>(atoi(arguments[1])));
  if (count > 3) {
    read_texts(&sanitized);
  } else {
    read_lines(&sanitized);
  }
  return 0;
}
