// The interrupt for each change of an echo pin: `on_change` of `ultrasonic.cpp` in assembly, for a
// robot with one sensor.
//
// A stop waits for interrupts. This one takes the time and then lets the others in for two
// instructions, and again where all is stored; the function, called through the shared frame, would
// keep them out for 9 us. A change that comes in between is another of these: the one outside then
// finds the level that the line has since.

#pragma once

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stddef.h>

#include "clock.h"
#include "echo.h"

namespace tiniscript {

// `Record` has `echo_state` (of type `EchoState`), `rose_us`, `fell_us` and `high_again_us`. Saves
// the registers that it changes and returns from the interrupt.
template <class Record, class EchoState>
tini_always_inline void on_echo_edge(Record* record, Echo echo, uint8_t glitch_us) {
  asm volatile(
      "push r24\n\tin r24, __SREG__\n\tpush r24\n\tpush r25\n\t"
      "in r24, %[count]\n\tlds r25, %[clock] + %[turns]\n\t"
      "sbis %[flags], %[overflow]\n\trjmp 1f\n\t"
      "cpi r24, 0xff\n\tbreq 1f\n\tinc r25\n"  // an overflow whose interrupt is pending
      "1: sei\n\tpush r23\n\tpush r30\n\tcli\n\tpush r31\n\t"
      "lsl r24\n\trol r25\n\tlsl r24\n\trol r25\n\t"  // us
      "ldi r30, lo8(%[record])\n\tldi r31, hi8(%[record])\n\t"
      "lds r23, %[pin]\n\tandi r23, %[mask]\n\t"
      "ldd r23, Z+%[heard]\n\tbreq 3f\n\t"
      // It is high.
      "cpi r23, %[nothing]\n\tbrne 2f\n\t"
      "std Z+%[rose], r24\n\tstd Z+%[rose]+1, r25\n\t"
      "ldi r23, %[high]\n\trjmp 8f\n"
      "2: cpi r23, %[ended]\n\tbrne 9f\n\t"
      "std Z+%[again], r24\n\tstd Z+%[again]+1, r25\n\t"
      "ldd r23, Z+%[fell]\n\tsub r24, r23\n\tldd r23, Z+%[fell]+1\n\tsbc r25, r23\n\t"
      "subi r24, %[glitch]\n\tsbci r25, 0\n\tbrcc 9f\n\t"
      "ldi r23, %[high_again]\n\trjmp 8f\n"
      // It is low.
      "3: cpi r23, %[high]\n\tbrne 4f\n\t"
      "std Z+%[fell], r24\n\tstd Z+%[fell]+1, r25\n\t"
      "ldd r23, Z+%[rose]\n\tsub r24, r23\n\tldd r23, Z+%[rose]+1\n\tsbc r25, r23\n\t"
      "subi r24, %[glitch]\n\tsbci r25, 0\n\t"
      "ldi r23, %[nothing]\n\tbrcs 8f\n\trjmp 7f\n"
      "4: cpi r23, %[high_again]\n\tbrne 9f\n\t"
      "subi r24, %[glitch]\n\tsbci r25, 0\n\t"
      "ldd r23, Z+%[again]\n\tcp r24, r23\n\tldd r23, Z+%[again]+1\n\tcpc r25, r23\n\tbrmi 7f\n\t"
      "subi r24, lo8(-(%[glitch]))\n\tsbci r25, hi8(-(%[glitch]))\n\t"
      "std Z+%[fell], r24\n\tstd Z+%[fell]+1, r25\n"
      "7: ldi r23, %[ended]\n"
      "8: std Z+%[heard], r23\n"
      "9: sei\n\t"
      "pop r31\n\tpop r30\n\tpop r23\n\tpop r25\n\t"
      "pop r24\n\tout __SREG__, r24\n\tpop r24\n\treti"
      :
      : [count] "I"(_SFR_IO_ADDR(TCNT0)), [flags] "I"(_SFR_IO_ADDR(TIFR0)), [overflow] "I"(TOV0),
        [clock] "i"(&clock), [turns] "I"(offsetof(Clock, turns)), [pin] "n"(echo.pin.port - 2),
        [mask] "M"(0 + echo.pin.mask), [record] "i"(record),
        [heard] "I"(offsetof(Record, echo_state)), [rose] "I"(offsetof(Record, rose_us)),
        [fell] "I"(offsetof(Record, fell_us)), [again] "I"(offsetof(Record, high_again_us)),
        [nothing] "M"(static_cast<int>(EchoState::kNothing)),
        [high] "M"(static_cast<int>(EchoState::kHigh)),
        [ended] "M"(static_cast<int>(EchoState::kEnded)),
        [high_again] "M"(static_cast<int>(EchoState::kHighAgain)), [glitch] "M"(0 + glitch_us));
}

}  // namespace tiniscript
