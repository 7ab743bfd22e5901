// Counts cycles of a simulated ATmega328P: with timer 1, which counts them all, and timer 0, which
// counts 1,024 of them for what timer 1 cannot hold.
//
// For the one file of a program that includes it.

#pragma once

#include <avr/io.h>
#include <stdint.h>

namespace counter {

constexpr uint32_t kLongest = 200 * 1024UL;  // cycles between two looks: past 2^18 both wrap

// Volatile, so that they are read and written in exactly this order.
volatile uint8_t coarse_count;
volatile uint16_t fine_count;

__attribute__((always_inline)) inline void start() {
  coarse_count = TCNT0;
  fine_count = TCNT1;
  asm volatile("" ::: "memory");
}

// Returns the cycles since `start`.
__attribute__((always_inline)) inline uint32_t cycles() {
  asm volatile("" ::: "memory");
  const uint16_t fine_cycles = static_cast<uint16_t>(TCNT1 - fine_count);
  const uint32_t coarse_cycles = static_cast<uint32_t>(static_cast<uint8_t>(TCNT0 - coarse_count))
                                 << 10;
  // the right number has the low bits of `fine_cycles` and is next to `coarse_cycles`
  return coarse_cycles + static_cast<uint32_t>(static_cast<int16_t>(
                             fine_cycles - static_cast<uint16_t>(coarse_cycles)));
}

// Starts the timers; returns the cycles that looking at them takes.
inline uint32_t begin() {
  TCCR0B = _BV(CS02) | _BV(CS00);  // a count in 1,024 cycles
  TCCR1B = _BV(CS10);              // each cycle
  start();
  return cycles();
}

}  // namespace counter
