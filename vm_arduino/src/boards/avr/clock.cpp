#ifdef __AVR__

#include "clock.h"

#include <Arduino.h>  // declares setup() and loop()

#include "../../vm/flags.h"
#include "attention.h"
#include "watchdog.h"

namespace tiniscript {

volatile Clock clock;

namespace {

constexpr uint8_t kParts = 125;    // per millisecond
constexpr uint8_t kTurnParts = 3;  // by which an overflow period of timer 0 exceeds 1 ms
constexpr uint8_t kBy64 = 1 << CS01 | 1 << CS00;  // the same bits for each of the timers here

// 16-bit timers run 8-bit phase-correct PWM.
void begin_timers() {
  TCCR0A = 1 << WGM01 | 1 << WGM00;
  TCCR0B = kBy64;
  TIMSK0 = 1 << TOIE0;
  TCCR1A = 1 << WGM10;
  TCCR1B = kBy64;
#ifdef TCCR5A
  TCCR3A = 1 << WGM10;
  TCCR3B = kBy64;
  TCCR4A = 1 << WGM10;
  TCCR4B = kBy64;
  TCCR5A = 1 << WGM10;
  TCCR5B = kBy64;
#endif
}

}  // namespace

uint32_t clock_ms() {
  const CriticalSection critical;
  return clock.now_ms;
}

uint16_t clock_us() {
  const CriticalSection critical;
  uint8_t turns = clock.turns;
  const uint8_t count = TCNT0;
  if ((TIFR0 & 1 << TOV0) != 0 && count != 0xff) turns++;  // an overflow whose interrupt is pending
  return static_cast<uint16_t>((turns << 8 | count) << 2);
}

}  // namespace tiniscript

// In a frame of its own, which is quicker: the pulses of servos wait for it.
ISR(TIMER0_OVF_vect) {
  using namespace tiniscript;
  call_attention();
  uint8_t passed_ms = 1;
  uint8_t fraction = static_cast<uint8_t>(clock.fraction + kTurnParts);
  if (fraction >= kParts) {
    fraction = static_cast<uint8_t>(fraction - kParts);
    passed_ms = 2;
  }
  clock.fraction = fraction;
  clock.now_ms = clock.now_ms + passed_ms;
  clock.turns = static_cast<uint8_t>(clock.turns + 1);
  const uint8_t silence_ms = static_cast<uint8_t>(clock.silence_ms + 1);
  clock.silence_ms = silence_ms;
  if (silence_ms > kStallMs) watchdog_is_stalled();
}

int main() __attribute__((OS_main));
int main() {
  tiniscript::begin_flags();
  tiniscript::begin_timers();
  sei();
  setup();
  for (;;) loop();
}

#endif  // __AVR__
