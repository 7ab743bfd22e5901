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
    std::string text(u32(), '\0');
    for (char& letter : text) letter = static_cast<char>(next());
    return text;
  }

  // `zero_bytes` more bytes, all 0, follow those that were sent.
  Bytes bytes(size_t zero_bytes = 0) {
    const size_t length = u32();
    Bytes copy{std::unique_ptr<uint8_t[]>(new uint8_t[length + zero_bytes]()), length};
    for (size_t k = 0; k < length; k++) copy.data[k] = next();
    return copy;
  }

 private:
  uint8_t next() {
    if (offset_ >= data_.size()) abort();
    return static_cast<uint8_t>(data_[offset_++]);
  }

  std::string data_;
  size_t offset_ = 0;
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
inline std::string with_times(uint32_t ms, const std::string& lines) {
  std::string timed_lines;
  for (size_t start = 0, end; start < lines.size(); start = end) {
    end = lines.find('\n', start) + 1;
    timed_lines += std::to_string(ms) + " " + lines.substr(start, end - start);
  }
  return timed_lines;
}

// Reads the next request, without its length; false at the end of the input.
inline bool next_request(std::string* request_data) {
  unsigned char head[4];
  if (fread(head, 1, sizeof head, stdin) != sizeof head) return false;
  request_data->resize(RequestReader(std::string(head, head + sizeof head)).u32());
  if (request_data->empty()) return true;
  if (fread(&(*request_data)[0], 1, request_data->size(), stdin) != request_data->size()) exit(1);
  return true;
}

inline void send_answer(const Writer& answer) {
  Writer head;
  head.u32(static_cast<uint32_t>(answer.data().size()));
  fwrite(head.data().data(), 1, head.data().size(), stdout);
  fwrite(answer.data().data(), 1, answer.data().size(), stdout);
  fflush(stdout);
}

// What answers a request, by its first byte.
using Answers = std::map<char, void (*)(RequestReader*, Writer*)>;

// Answers a request; false if its first byte is none of these.
inline bool answer_request(const Answers& answers, const std::string& request_data,
                           Writer* answer) {
  RequestReader request(request_data);
  const auto handler = answers.find(static_cast<char>(request.u8()));
  if (handler == answers.end()) return false;
  handler->second(&request, answer);
  return true;
}

// Answers requests up to the end of the input; returns false at one that it does not know.
inline bool answer_all_requests(const Answers& answers) {
  std::string request_data;
  while (next_request(&request_data)) {
    Writer answer;
    if (!answer_request(answers, request_data, &answer)) return false;
    send_answer(answer);
  }
  return true;
}
