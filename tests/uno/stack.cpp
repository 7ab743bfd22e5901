// Takes stack: 300 bytes in its program, and then 100 in an interrupt, deeper than the program.
//
// With kWaits the interrupt comes while the program is at its deepest.

#include <avr/interrupt.h>
#include <avr/io.h>

namespace {

volatile bool is_deep;

__attribute__((noinline)) void take(uint16_t bytes_left, bool waits) {
  volatile uint8_t taken[10];
  for (volatile uint8_t& byte : taken) byte = 0x55;
  if (bytes_left > sizeof taken) {
    take(static_cast<uint16_t>(bytes_left - sizeof taken), waits);
    taken[0] = 0x66;  // so that this is no jump
  } else if (waits) {
    is_deep = true;
    while (is_deep) {
    }
  }
}

}  // namespace

ISR(TIMER0_OVF_vect) {
  take(kInterrupt, false);
  is_deep = false;
}

int main() {
  TCCR0B = _BV(CS01);  // an interrupt each 128 us
  if (!kWaits) take(kProgram, false);
  TIMSK0 = _BV(TOIE0);
  sei();
  if (kWaits) take(kProgram, true);
  for (;;) {
  }
}
