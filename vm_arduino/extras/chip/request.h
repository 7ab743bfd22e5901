// Reads a request from one place on: numbers are little-endian, texts have their length before.

#pragma once

#include "port.h"

namespace tiniscript {

class Request {
 public:
  explicit Request(size_t place) : place_(place) {}

  size_t place() const { return place_; }
  void skip(size_t length) { place_ += length; }

  uint8_t u8() { return request_byte(place_++); }
  uint16_t u16() {
    const uint16_t low = u8();
    return static_cast<uint16_t>(low | static_cast<uint16_t>(u8()) << 8);
  }
  uint32_t u32() {
    const uint32_t low = u16();
    return low | static_cast<uint32_t>(u16()) << 16;
  }
  int32_t i32() { return static_cast<int32_t>(u32()); }

  // Skips a text; returns where its length stands.
  size_t text() {
    const size_t start = place_;
    const size_t length = static_cast<size_t>(u32());
    skip(length);
    return start;
  }

 private:
  size_t place_;
};

}  // namespace tiniscript
