// Runs the machine on an emulated chip, for tests: many requests to one emulator.
//
// Requests and answers are those of `../chip/answers.h`. Ends with its input.

#include "../chip/answers.h"
#include "host.h"
#include "reading.h"

namespace tiniscript {

namespace {

constexpr uint32_t kPipeBytes = 0x200000;

uint8_t asked[kPipeBytes];
uint8_t answered[kPipeBytes];
uint8_t bytes_asked[0x20000];
uint32_t asked_length;
uint32_t answered_length;

// False at the end of the input.
bool read_all(uint8_t* data, uint32_t length) {
  while (length != 0) {
    const uint32_t taken = host_read(data, length);
    if (taken == 0) return false;
    data += taken;
    length -= taken;
  }
  return true;
}

// False where nobody reads.
bool write_all(const uint8_t* data, uint32_t length) {
  while (length != 0) {
    const uint32_t taken = host_write(data, length);
    if (taken == 0) return false;
    data += taken;
    length -= taken;
  }
  return true;
}

bool answer_one() {
  uint8_t head[4];
  if (!read_all(head, sizeof head)) return false;
  asked_length = 0;
  for (uint8_t k = sizeof head; k != 0; k--) asked_length = asked_length << 8 | head[k - 1];
  if (asked_length > kPipeBytes || !read_all(asked, asked_length)) return false;
  answered_length = 0;
  Request request(0);
  if (request.u8() == 'T') {
    answer_texts(request, asked_length);
  } else if (!answer_any(Request(0), asked_length)) {
    return false;
  }
  for (uint8_t k = 0; k < sizeof head; k++) {
    head[k] = static_cast<uint8_t>(answered_length >> (8 * k));
  }
  return write_all(head, sizeof head) && write_all(answered, answered_length);
}

}  // namespace

uint8_t request_byte(size_t place) { return place < asked_length ? asked[place] : 0; }

const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  if (length > sizeof bytes_asked || zeros > sizeof bytes_asked - length) return nullptr;
  for (size_t k = 0; k < length; k++) bytes_asked[k] = request_byte(place + k);
  for (size_t k = 0; k < zeros; k++) bytes_asked[length + k] = 0;
  return bytes_asked;
}

void put(char letter) {
  if (answered_length < kPipeBytes) answered[answered_length++] = static_cast<uint8_t>(letter);
}

}  // namespace tiniscript

void serve() {
  while (tiniscript::answer_one()) {
  }
}
