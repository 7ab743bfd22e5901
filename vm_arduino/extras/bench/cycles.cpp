// Runs code on a simulated ATmega328P and says how many cycles the machine took.
//
// Only what is inside `tick` is counted; time goes on where the program waits. The robot costs next
// to nothing: readings are numbers in memory, and what is shown is told at the end.

#include "../../src/vm/machine.h"
#include "../avr/simulated.h"
#include "counter.h"
#include "quiet_robot.h"

using namespace tiniscript;
using simulated::request;
using simulated::say;

namespace {

constexpr uint16_t kCodeBytes = 512;

uint8_t code[kCodeBytes + kEndBytes];
Machine machine;
int32_t machine_readings[8];

void run() {
  const uint8_t budget = request.u8();
  const uint8_t count = request.u8();
  for (uint8_t k = 0; k < count; k++) readings[k] = static_cast<int32_t>(request.u32());
  const uint16_t length = request.u16();
  for (uint16_t k = 0; k < length; k++) code[k] = request.u8();
  for (uint8_t k = 0; k < kEndBytes; k++) code[length + k] = static_cast<uint8_t>(Op::kEnd);
  machine.start(code, length, machine_readings, 8, 1, 0);

  const uint32_t overhead = counter::begin();
  uint32_t total = 0;
  uint32_t longest = 0;
  uint32_t now_ms = 0;
  Status status;
  do {
    counter::start();
    status = machine.tick(now_ms, budget);
    const uint32_t cycles = counter::cycles() - overhead;
    total += cycles;
    if (cycles > longest) longest = cycles;
    if (status == Status::kWaiting) now_ms++;
  } while (status < Status::kDone && longest < counter::kLongest);
  for (uint8_t k = 0; k < show_count; k++) say("SHOW", shown_values[k]);
  say("CYCLES", static_cast<int32_t>(total));
  say("STATUS", static_cast<uint8_t>(status));
}

}  // namespace

int main() {
  simulated::begin();
  run();
  simulated::end();
}
