// Runs one image, or code, on a simulated ATmega, for tests, and reports over the UART what the robot
// did.
//
// The request begins with R for an image, with L and 4 bytes for an image whose ticks after a wait
// come so many milliseconds late, and with U for code that is not verified. The clock is simulated
// as in `vm/runner.py`.

#include "../../src/vm/vm.h"
#include "../chip/runner.h"
#include "simulated.h"

namespace tiniscript {

namespace {

constexpr size_t kImageBytes = 700;

uint8_t image_bytes[kImageBytes + kEndBytes];

}  // namespace

const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  if (length + zeros > sizeof image_bytes) return nullptr;
  for (size_t k = 0; k < length; k++) image_bytes[k] = request_byte(place + k);
  for (size_t k = 0; k < zeros; k++) image_bytes[length + k] = 0;
  return image_bytes;
}

}  // namespace tiniscript

int main() {
  simulated::begin();
  const uint8_t kind = simulated::request.u8();
  const uint32_t late_ms = kind == 'L' ? simulated::request.u32() : 0;
  tiniscript::answer_run(simulated::request, kind != 'U', late_ms);
  simulated::end();
}
