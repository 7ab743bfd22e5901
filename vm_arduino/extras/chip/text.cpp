#include "text.h"

#include "../../src/vm/number.h"
#include "port.h"

namespace tiniscript {

namespace {

// Adds the sign; returns the number without it.
uint32_t put_sign(int32_t value) {
  const uint32_t bits = static_cast<uint32_t>(value);
  if (value >= 0) return bits;
  put('-');
  return 0 - bits;
}

}  // namespace

void put_text(const char* text) {
  while (*text != 0) put(*text++);
}

void put_size(unsigned long size) {
  char digits[20];
  uint8_t count = 0;
  do {
    digits[count++] = static_cast<char>('0' + size % 10);
    size /= 10;
  } while (size != 0);
  while (count != 0) put(digits[--count]);
}

void put_number(int32_t value) { put_size(put_sign(value)); }

void put_value(int32_t value, bool is_yes_no) {
  if (is_yes_no) return put_text(value != 0 ? "TRUE" : "FALSE");
  const uint32_t size = put_sign(value);
  put_size(size / kOne);
  uint16_t fraction = static_cast<uint16_t>(size % kOne);
  if (fraction != 0) put('.');
  for (uint16_t unit = 100; fraction != 0; unit /= 10) {
    put(static_cast<char>('0' + fraction / unit));
    fraction %= unit;
  }
}

}  // namespace tiniscript
