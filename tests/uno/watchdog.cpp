// Shows on port B what a watchdog does: D8 at each begin, D9 in its interrupt, D10 after a reset by
// it, D11 where memory has kept its mark. Interrupts are off where kIsOff is 1; where it is 2 the
// chip sleeps besides.

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

namespace {

uint8_t mark __attribute__((section(".noinit")));

}  // namespace

ISR(WDT_vect) { PORTB |= _BV(1); }

int main() {
  const uint8_t causes = MCUSR;
  MCUSR = 0;
  wdt_disable();
  DDRB = 0x0f;
  PORTB |= _BV(0);
  if (causes & _BV(WDRF)) PORTB |= _BV(2);
  if (mark == 0xa5) PORTB |= _BV(3);
  mark = 0xa5;
  if (causes & _BV(WDRF)) {
    for (;;) {
    }
  }
  wdt_enable(WDTO_30MS);
  WDTCSR |= _BV(WDIE);
  if (!kIsOff) sei();
  for (;;) {
    if (kIsOff == 2) sleep_mode();
  }
}
