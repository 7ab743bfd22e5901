// Numbers and bytes of requests and answers: little-endian, texts after their length.

#pragma once

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <map>
#include <memory>
#include <string>
#include <utility>

// Bytes of exactly their length, so that a sanitizer detects a read past the end.
struct Bytes {
  std::unique_ptr<uint8_t[]> data;
  size_t length;
};

class RequestReader {
 public:
  explicit RequestReader(std::string data) : data_(std::move(data)) {}

  uint32_t number(int size) {
    uint32_t value = 0;
    for (int k = 0; k < size; k++) value |= static_cast<uint32_t>(next()) << (8 * k);
    return value;
  }
  uint8_t u8() { return next(); }
  uint16_t u16() { return static_cast<uint16_t>(number(2)); }
  uint32_t u32() { return number(4); }
  int32_t i32() { return static_cast<int32_t>(number(4)); }

  std::string text() {
    std::string found(u32(), '\0');
    for (char& each : found) each = static_cast<char>(next());
    return found;
  }

  // `more` zero bytes follow those that were sent.
  Bytes bytes(size_t more = 0) {
    const size_t length = u32();
    Bytes found{std::unique_ptr<uint8_t[]>(new uint8_t[length + more]()), length};
    for (size_t k = 0; k < length; k++) found.data[k] = next();
    return found;
  }

 private:
  uint8_t next() {
    if (at_ >= data_.size()) abort();
    return static_cast<uint8_t>(data_[at_++]);
  }

  std::string data_;
  size_t at_ = 0;
};

class Writer {
 public:
  void number(uint32_t value, int size) {
    for (int k = 0; k < size; k++) data_ += static_cast<char>(value >> (8 * k) & 0xff);
  }
  void u8(uint8_t value) { number(value, 1); }
  void u16(uint16_t value) { number(value, 2); }
  void u32(uint32_t value) { number(value, 4); }
  void text(const std::string& text) {
    u32(static_cast<uint32_t>(text.size()));
    data_ += text;
  }
  void raw(const std::string& text) { data_ += text; }
  const std::string& data() const { return data_; }

 private:
  std::string data_;
};

// Returns lines, each after the time of all.
inline std::string timed(uint32_t ms, const std::string& lines) {
  std::string found;
  for (size_t at = 0, end; at < lines.size(); at = end) {
    end = lines.find('\n', at) + 1;
    found += std::to_string(ms) + " " + lines.substr(at, end - at);
  }
  return found;
}

// Reads the next request, without its length; false at the end of the input.
inline bool next_request(std::string* asked) {
  unsigned char head[4];
  if (fread(head, 1, sizeof head, stdin) != sizeof head) return false;
  asked->resize(RequestReader(std::string(head, head + sizeof head)).u32());
  if (asked->empty()) return true;
  if (fread(&(*asked)[0], 1, asked->size(), stdin) != asked->size()) exit(1);
  return true;
}

inline void send_answer(const Writer& said) {
  Writer head;
  head.u32(static_cast<uint32_t>(said.data().size()));
  fwrite(head.data().data(), 1, head.data().size(), stdout);
  fwrite(said.data().data(), 1, said.data().size(), stdout);
  fflush(stdout);
}

// What answers a request, by its first byte.
using Answers = std::map<char, void (*)(RequestReader*, Writer*)>;

// Answers a request; false if its first byte is none of these.
inline bool answered(const Answers& answers, const std::string& asked, Writer* said) {
  RequestReader request(asked);
  const auto found = answers.find(static_cast<char>(request.u8()));
  if (found == answers.end()) return false;
  found->second(&request, said);
  return true;
}

// Answers requests up to the end of the input; returns false at one that it does not know.
inline bool all_answered(const Answers& answers) {
  std::string asked;
  while (next_request(&asked)) {
    Writer said;
    if (!answered(answers, asked, &said)) return false;
    send_answer(said);
  }
  return true;
}
