// Runs one image, or code, on a simulated ATmega, for tests, and reports over the UART what the robot
// did.
//
// The request begins with R for an image, with P for one at a pace, and with U for code that is not
// verified. The clock is simulated
// as in `vm/runner.py`.

#include "../../src/vm/machine.h"
#include "../chip/runner.h"
#include "simulated.h"

namespace tiniscript {

namespace {

constexpr size_t kImageBytes = 620;

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
  if (kind == 'P') {
    tiniscript::answer_run_at_pace(simulated::request);
  } else {
    tiniscript::answer_run(simulated::request, kind != 'U');
  }
  simulated::end();
}
