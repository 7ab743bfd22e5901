#ifdef __AVR__

#include "clock.h"

#include <Arduino.h>  // declares setup() and loop()
#include <stddef.h>

#include "../../vm/flags.h"
#include "events.h"
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

tini_noinline uint32_t clock_ms() {
  const CriticalSection critical;
  return clock.now_ms;
}

uint16_t clock_us() {
  const CriticalSection critical;
  return clock_us_inside();
}

}  // namespace tiniscript

static_assert(offsetof(tiniscript::Clock, turns) == 4 &&
                  offsetof(tiniscript::Clock, fraction) == 5 &&
                  offsetof(tiniscript::Clock, silence_ms) == 6,
              "the interrupt knows where they lie");

// In assembly, because a stop and the pulses of servos wait for it: the compiler's code takes twice
// as long. Others may come in between once `turns` is right, for two instructions, and once the
// time is whole.
ISR(TIMER0_OVF_vect, ISR_NAKED) {
  using namespace tiniscript;
  asm volatile(
      "push r24\n\tin r24, __SREG__\n\tpush r24\n\t"
      "lds r24, %[clock] + 4\n\tinc r24\n\tsts %[clock] + 4, r24\n\t"  // turns
      "sei\n\tpush r25\n\tpush r30\n\tcli\n\tpush r31\n\t"
      "sbi %[flags], %[event]\n\t"
      "ldi r30, lo8(%[clock])\n\tldi r31, hi8(%[clock])\n\t"
      "ldi r25, 1\n\t"  // ms that have passed
      "ldd r24, Z+5\n\tsubi r24, %[parts] - %[more]\n\tbrcc 1f\n\t"
      "subi r24, -%[parts]\n\trjmp 2f\n"
      "1: inc r25\n"
      "2: std Z+5, r24\n\t"
      "ld r24, Z\n\tadd r24, r25\n\tst Z, r24\n\tldi r25, 0\n\t"
      "ldd r24, Z+1\n\tadc r24, r25\n\tstd Z+1, r24\n\t"
      "sei\n\t"  // the interrupts read the lowest 16 bits alone
      "ldd r24, Z+2\n\tadc r24, r25\n\tstd Z+2, r24\n\t"
      "ldd r24, Z+3\n\tadc r24, r25\n\tstd Z+3, r24\n\t"
      "ldd r24, Z+6\n\tinc r24\n\tstd Z+6, r24\n\t"
      "cpi r24, %[stall] + 1\n\tbrcs 3f\n\t"
      "cli\n\tlds r24, %[mask]\n\tori r24, %[stalled]\n\tsts %[mask], r24\n"
      "3: pop r31\n\tpop r30\n\tpop r25\n\tpop r24\n\tout __SREG__, r24\n\tpop r24\n\treti"
      :
      : [flags] "I"(kFlagsAt - 0x20), [event] "I"(tini_event_bit), [clock] "i"(&clock),
        [parts] "M"(kParts), [more] "M"(kTurnParts), [stall] "M"(kStallMs),
        [mask] "n"(_SFR_MEM_ADDR(TIMSK0)), [stalled] "M"(1 << OCIE0A));
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
