#ifdef ARDUINO_ARCH_ESP32

#include "protocol_sniffer.h"

#include "../../link/messages.h"

namespace tiniscript {

namespace {

const char* const kMethods[] = {"GET",     "HEAD",    "POST",  "PUT",   "DELETE",
                                "CONNECT", "OPTIONS", "TRACE", "PATCH", "PRI"};
const char kMarks[] = "!#$%&'*+.^_`|~-";  // of a method, beside letters and digits

struct Text {
  const uint8_t* bytes;
  size_t length;

  bool has(size_t at) const { return at < length; }
};

uint8_t lower(uint8_t byte) {
  return byte >= 'A' && byte <= 'Z' ? static_cast<uint8_t>(byte | 0x20) : byte;
}

bool is_blank(uint8_t byte) { return byte == ' ' || byte == '\t'; }

bool is_end(uint8_t byte) { return byte == '\r' || byte == '\n' || byte == 0; }

bool is_letter(uint8_t byte) { return lower(byte) >= 'a' && lower(byte) <= 'z'; }

bool is_of_method(uint8_t byte) {
  if (is_letter(byte) || (byte >= '0' && byte <= '9')) return true;
  for (const char* mark = kMarks; *mark != 0; mark++) {
    if (byte == static_cast<uint8_t>(*mark)) return true;
  }
  return false;
}

size_t skip_blanks(Text line, size_t at) {
  while (line.has(at) && is_blank(line.bytes[at])) at++;
  return at;
}

// Whether these letters are at a place; upper and lower case are the same.
bool is_at(Text line, size_t at, const char* word) {
  for (; *word != 0; word++, at++) {
    if (!line.has(at) || lower(line.bytes[at]) != lower(static_cast<uint8_t>(*word))) return false;
  }
  return true;
}

size_t length_of(const char* word) {
  size_t length = 0;
  while (word[length] != 0) length++;
  return length;
}

bool is_known_request(Text line, size_t method_end, size_t target) {
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
bool is_request(Text line, size_t target) {
  size_t at = target;
  while (line.has(at) && line.bytes[at] > ' ') at++;
  const size_t behind = skip_blanks(line, at);
  return at != target && behind != at && is_at(line, behind, "HTTP/");
}

Protocol sniffed_text(const uint8_t* bytes, size_t length) {
  Text line = {bytes, 0};
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
  return length <= kFirstBytes ? Protocol::kUnknownYet : Protocol::kOther;
}

// A frame has eight bytes and more without a zero, and a type that is not 0: no 0x01 first.
Protocol sniffed_frame(const uint8_t* bytes, size_t length) {
  for (size_t k = 0; k < length && k < 3; k++) {
    if (bytes[k] == 0) return Protocol::kOther;
  }
  if (bytes[0] == 1) return Protocol::kOther;  // STUN
  if (length < 3) return Protocol::kUnknownYet;
  const bool is_tls = bytes[0] == 0x16 && bytes[1] == 0x03;
  return is_tls ? Protocol::kOther : Protocol::kForRobot;
}

}  // namespace

Protocol sniffed(const uint8_t* bytes, size_t length) {
  size_t at = 0;
  while (at < length && bytes[at] == 0) at++;
  if (at > 1) return Protocol::kForRobot;  // the stop sequence: zeros alone do nothing else
  size_t behind = at;
  while (behind < length && (bytes[behind] == '\r' || bytes[behind] == '\n')) behind++;
  if (behind == length || is_letter(bytes[behind])) at = behind;  // servers of HTTP skip these
  if (at == length) return length <= kFirstBytes ? Protocol::kUnknownYet : Protocol::kOther;
  return bytes[at] < kTextFrom ? sniffed_frame(bytes + at, length - at)
                               : sniffed_text(bytes + at, length - at);
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
