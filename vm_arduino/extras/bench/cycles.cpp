// Runs code on a simulated ATmega328P and says how many cycles the machine took.
//
// Only what is inside `tick` is counted: with timer 1, which counts cycles, and timer 0, which
// counts 1,024 of them for what timer 1 cannot hold. The cost of looking at the timers is measured
// and taken off. The robot costs next to nothing: readings are numbers in memory, and what is shown
// is told at the end.

#include "../../src/vm/vm.h"
#include "quiet_robot.h"
#include "simulated.h"

using namespace tiniscript;

namespace {

constexpr uint16_t kCodeBytes = 512;
constexpr uint32_t kLongest = 200 * 1024UL;  // cycles of a tick: behind 2^18 both timers wrap

uint8_t code[kCodeBytes + kEndBytes];
Machine machine;
int32_t kept[8];

// Volatile, so that they are read and written in exactly this order.
volatile uint8_t coarse;
volatile uint16_t fine;

__attribute__((always_inline)) inline void begin_count() {
  coarse = TCNT0;
  fine = TCNT1;
  asm volatile("" ::: "memory");
}

// Returns the cycles since `begin_count`.
__attribute__((always_inline)) inline uint32_t counted() {
  asm volatile("" ::: "memory");
  const uint16_t cycles = static_cast<uint16_t>(TCNT1 - fine);
  const uint32_t about = static_cast<uint32_t>(static_cast<uint8_t>(TCNT0 - coarse)) << 10;
  // the right number has the low bits of `cycles` and is next to `about`
  return about + static_cast<uint32_t>(static_cast<int16_t>(cycles - static_cast<uint16_t>(about)));
}

void run() {
  const uint8_t budget = simulated::next_byte();
  const uint8_t count = simulated::next_byte();
  for (uint8_t k = 0; k < count; k++) readings[k] = static_cast<int32_t>(simulated::next_long());
  const uint16_t length = simulated::next_word();
  for (uint16_t k = 0; k < length; k++) code[k] = simulated::next_byte();
  for (uint8_t k = 0; k < kEndBytes; k++) code[length + k] = static_cast<uint8_t>(Op::kEnd);
  machine.start(code, length, kept, 8, 1, 0);

  begin_count();
  const uint32_t nothing = counted();
  uint32_t total = 0;
  uint32_t jumps = 0;  // back, and calls
  uint32_t longest = 0;
  Status status;
  do {
    begin_count();
    status = machine.tick(0, budget);
    const uint32_t cycles = counted() - nothing;
    total += cycles;
    jumps += static_cast<uint8_t>(budget - machine.left());
    if (cycles > longest) longest = cycles;
  } while (status == Status::kRunning && longest < kLongest);
  for (uint8_t k = 0; k < shows; k++) simulated::say("SHOW", shown[k]);
  simulated::say("LONGEST", static_cast<int32_t>(longest));
  simulated::say("JUMPS", static_cast<int32_t>(jumps));
  simulated::say("CYCLES", static_cast<int32_t>(total));
  simulated::say("STATUS", static_cast<uint8_t>(status));
}

}  // namespace

int main() {
  simulated::begin();
  TCCR0B = _BV(CS02) | _BV(CS00);  // a count in 1,024 cycles
  TCCR1B = _BV(CS10);              // each cycle
  run();
  simulated::end();
}
