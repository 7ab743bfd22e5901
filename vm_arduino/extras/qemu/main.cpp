// Runs the machine on an emulated chip, for tests: many requests to one emulator.
//
// Requests and answers are those of `../chip/answers.h`. Ends with its input.

#include "../chip/answers.h"
#include "host.h"
#include "reading.h"

namespace tiniscript {

namespace {

constexpr uint32_t kPipeBytes = 0x200000;

uint8_t request_data[kPipeBytes];
uint8_t answer[kPipeBytes];
uint8_t copied_bytes[0x20000];
uint32_t request_length;
uint32_t answer_length;

// False at the end of the input.
bool read_all(uint8_t* data, uint32_t length) {
  while (length != 0) {
    const uint32_t count = host_read(data, length);
    if (count == 0) return false;
    data += count;
    length -= count;
  }
  return true;
}

// False where nobody reads.
bool write_all(const uint8_t* data, uint32_t length) {
  while (length != 0) {
    const uint32_t count = host_write(data, length);
    if (count == 0) return false;
    data += count;
    length -= count;
  }
  return true;
}

bool answer_one() {
  uint8_t head[4];
  if (!read_all(head, sizeof head)) return false;
  request_length = 0;
  for (uint8_t k = sizeof head; k != 0; k--) request_length = request_length << 8 | head[k - 1];
  if (request_length > kPipeBytes || !read_all(request_data, request_length)) return false;
  answer_length = 0;
  Request request(0);
  if (request.u8() == 'T') {
    answer_texts(request, request_length);
  } else if (!answer_any(Request(0), request_length)) {
    return false;
  }
  for (uint8_t k = 0; k < sizeof head; k++) {
    head[k] = static_cast<uint8_t>(answer_length >> (8 * k));
  }
  return write_all(head, sizeof head) && write_all(answer, answer_length);
}

}  // namespace

uint8_t request_byte(size_t place) { return place < request_length ? request_data[place] : 0; }

const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  if (length > sizeof copied_bytes || zeros > sizeof copied_bytes - length) return nullptr;
  for (size_t k = 0; k < length; k++) copied_bytes[k] = request_byte(place + k);
  for (size_t k = 0; k < zeros; k++) copied_bytes[length + k] = 0;
  return copied_bytes;
}

void put(char letter) {
  if (answer_length < kPipeBytes) answer[answer_length++] = static_cast<uint8_t>(letter);
}

}  // namespace tiniscript

void serve() {
  while (tiniscript::answer_one()) {
  }
}
