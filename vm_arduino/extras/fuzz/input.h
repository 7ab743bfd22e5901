// What a fuzzer has made, byte by byte; 0 after its end.

#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

class Input {
 public:
  Input(const uint8_t* data, size_t size) : data_(data), size_(size), offset_(0) {}

  bool has_more() const { return offset_ < size_; }
  size_t remaining() const { return size_ - offset_; }
  uint8_t u8() { return offset_ < size_ ? data_[offset_++] : 0; }
  uint16_t u16() {
    const uint8_t low = u8();
    return static_cast<uint16_t>(low | u8() << 8);
  }

 private:
  const uint8_t* data_;
  size_t size_;
  size_t offset_;
};

// Ends the run with what must not be: the fuzzer keeps its input.
#define must(what)                 \
  do {                             \
    if (!(what)) {                 \
      printf("WRONG %s\n", #what); \
      fflush(stdout);              \
      abort();                     \
    }                              \
  } while (false)

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);
