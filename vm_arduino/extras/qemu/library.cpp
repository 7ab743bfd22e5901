// What a compiler expects to find in its library, for chips whose library is not installed: bytes
// are copied and set here, and divided for a chip that has no instruction for it.

#include <stddef.h>
#include <stdint.h>

extern "C" {

void* memcpy(void* to, const void* from, size_t length) {
  char* out = static_cast<char*>(to);
  const char* in = static_cast<const char*>(from);
  while (length-- != 0) *out++ = *in++;
  return to;
}

void* memmove(void* to, const void* from, size_t length) {
  char* out = static_cast<char*>(to);
  const char* in = static_cast<const char*>(from);
  if (out <= in) return memcpy(to, from, length);
  while (length-- != 0) out[length] = in[length];
  return to;
}

void* memset(void* to, int value, size_t length) {
  char* out = static_cast<char*>(to);
  while (length-- != 0) *out++ = static_cast<char>(value);
  return to;
}

// The quotient in the lower half, the remainder in the upper one.
static uint64_t divide(uint32_t size, uint32_t divisor) {
  uint32_t remainder = 0;
  for (uint8_t bit = 32; bit != 0; bit--) {
    const bool carry = (remainder & 0x80000000) != 0;
    remainder = remainder << 1 | size >> 31;
    size <<= 1;
    if (carry || remainder >= divisor) {
      remainder -= divisor;
      size++;
    }
  }
  return static_cast<uint64_t>(remainder) << 32 | size;
}

uint32_t __udivsi3(uint32_t a, uint32_t b) { return static_cast<uint32_t>(divide(a, b)); }

uint32_t __umodsi3(uint32_t a, uint32_t b) { return static_cast<uint32_t>(divide(a, b) >> 32); }

int32_t __divsi3(int32_t a, int32_t b) {
  const uint32_t size = __udivsi3(a < 0 ? 0 - static_cast<uint32_t>(a) : static_cast<uint32_t>(a),
                                  b < 0 ? 0 - static_cast<uint32_t>(b) : static_cast<uint32_t>(b));
  return static_cast<int32_t>((a < 0) != (b < 0) ? 0 - size : size);
}
}
