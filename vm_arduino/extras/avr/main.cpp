// Runs one image, or code, on a simulated ATmega328P, for tests, and reports over the UART what the robot
// did.
//
// The request lies in flash: `tests/machines/avr.py` writes it into the built program. It begins
// with R for an image, with L and 4 bytes for an image whose ticks after a wait come so many
// milliseconds late, and with U for code that is not verified. The clock is simulated as in `run.py`.
// Ends by sleeping without interrupts: that ends the simulator too.

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

#include "../../src/vm/flash.h"
#include "../../src/vm/vm.h"
#include "../chip/runner.h"

namespace tiniscript {

namespace {

constexpr size_t kRequestBytes = 8192;
constexpr size_t kImageBytes = 700;

// A test finds it by its first bytes and overwrites it.
const uint8_t kRequest[kRequestBytes] tini_progmem = {"TiniScript: here is the request"};

uint8_t image_bytes[kImageBytes + kEndBytes];

}  // namespace

uint8_t request_byte(size_t place) {
  return place < kRequestBytes ? flash_byte(kRequest + place) : 0;
}

const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  if (length + zeros > sizeof image_bytes) return nullptr;
  for (size_t k = 0; k < length; k++) image_bytes[k] = request_byte(place + k);
  for (size_t k = 0; k < zeros; k++) image_bytes[length + k] = 0;
  return image_bytes;
}

void put(char letter) {
  while ((UCSR0A & _BV(UDRE0)) == 0) {
  }
  UDR0 = static_cast<uint8_t>(letter);
}

}  // namespace tiniscript

int main() {
  UCSR0A = _BV(U2X0);
  UCSR0B = _BV(TXEN0);
  UBRR0 = 0;
  tiniscript::Request request(0);
  const uint8_t kind = request.u8();
  const uint32_t late_ms = kind == 'L' ? request.u32() : 0;
  tiniscript::answer_run(request, kind != 'U', late_ms);
  while ((UCSR0A & _BV(TXC0)) == 0) {
  }
  cli();
  sleep_mode();
}
