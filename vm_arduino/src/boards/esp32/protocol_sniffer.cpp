#ifdef ARDUINO_ARCH_ESP32

#include "protocol_sniffer.h"

namespace tiniscript {

namespace {

const char* const kMethods[] = {"GET",     "HEAD",    "POST",  "PUT",   "DELETE",
                                "CONNECT", "OPTIONS", "TRACE", "PATCH", "PRI"};
const char kMarks[] = "!#$%&'*+.^_`|~-";  // of a method, beside letters and digits

struct Span {
  const uint8_t* bytes;
  size_t length;

  bool has(size_t at) const { return at < length; }
};

uint8_t lower(uint8_t byte) {
  return byte >= 'A' && byte <= 'Z' ? static_cast<uint8_t>(byte | 0x20) : byte;
}

bool is_blank(uint8_t byte) { return byte == ' ' || byte == '\t'; }

bool is_end(uint8_t byte) { return byte == '\r' || byte == '\n' || byte == 0; }

bool is_printable(uint8_t byte) { return byte >= ' ' && byte < 0x7f; }

bool is_of_method(uint8_t byte) {
  if (lower(byte) >= 'a' && lower(byte) <= 'z') return true;
  if (byte >= '0' && byte <= '9') return true;
  for (const char* mark = kMarks; *mark != 0; mark++) {
    if (byte == static_cast<uint8_t>(*mark)) return true;
  }
  return false;
}

size_t skip_blanks(Span line, size_t index) {
  while (line.has(index) && is_blank(line.bytes[index])) index++;
  return index;
}

// Whether these letters are at a place, in upper or lower case.
bool is_at(Span line, size_t index, const char* word) {
  for (; *word != 0; word++, index++) {
    if (!line.has(index) || lower(line.bytes[index]) != lower(static_cast<uint8_t>(*word)))
      return false;
  }
  return true;
}

size_t length_of(const char* word) {
  size_t length = 0;
  while (word[length] != 0) length++;
  return length;
}

bool is_known_request(Span line, size_t method_end, size_t target) {
  if (!line.has(target)) return false;
  const bool is_target = line.bytes[target] == '/' || line.bytes[target] == '*' ||
                         is_at(line, target, "http:") || is_at(line, target, "https:");
  if (!is_target) return false;
  for (const char* method : kMethods) {
    if (length_of(method) == method_end && is_at(line, 0, method)) return true;
  }
  return false;
}

// METHOD TARGET HTTP/
bool is_request(Span line, size_t target) {
  size_t target_end = target;
  while (line.has(target_end) && line.bytes[target_end] > ' ') target_end++;
  const size_t version_start = skip_blanks(line, target_end);
  return target_end != target && version_start != target_end && is_at(line, version_start, "HTTP/");
}

Protocol sniff_text(const uint8_t* bytes, size_t length) {
  const Protocol undecided = length <= kFirstBytes ? Protocol::kUnknownYet : Protocol::kOther;
  while (length != 0 && (*bytes == '\r' || *bytes == '\n')) {  // servers of HTTP skip empty lines
    bytes++;
    length--;
  }
  if (length == 0) return undecided;
  Span line = {bytes, 0};
  while (line.length < length && !is_end(bytes[line.length])) line.length++;
  size_t method_end = 0;
  while (line.has(method_end) && is_of_method(bytes[method_end])) method_end++;
  if (method_end == 0) return Protocol::kForRobot;
  if (line.has(method_end) && !is_blank(bytes[method_end])) return Protocol::kForRobot;  // `F(`
  const size_t target = skip_blanks(line, method_end);
  if (target != method_end) {
    if (is_request(line, target) || is_known_request(line, method_end, target))
      return Protocol::kOther;
    if (line.has(target) && bytes[target] == '=') return Protocol::kForRobot;  // `X = 5`
  }
  if (line.length < length) return Protocol::kForRobot;  // the line has ended, and is no request
  return undecided;
}

// Whether bytes begin like STUN, whose length may come first, or like TLS.
bool is_binary(const uint8_t* bytes, size_t length) {
  if (length < 2) return false;
  if (bytes[1] == 0 || (length > 2 && bytes[2] == 0)) return true;
  return (bytes[0] == 0 && bytes[1] == 1) || (bytes[0] == 0x16 && bytes[1] == 3);
}

}  // namespace

Protocol sniff_protocol(const uint8_t* bytes, size_t length) {
  if (length > 1 && bytes[0] == 0 && bytes[1] == 0) return Protocol::kForRobot;  // a stop sequence
  if (length == 0 || bytes[0] < ' ') {
    if (is_binary(bytes, length)) return Protocol::kOther;
    if (length < 3) return Protocol::kUnknownYet;
  }
  if (bytes[0] != 0) return sniff_text(bytes, length);
  const bool is_line = is_printable(bytes[1]) && is_printable(bytes[2]);
  return is_line ? sniff_text(bytes + 1, length - 1) : Protocol::kForRobot;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
