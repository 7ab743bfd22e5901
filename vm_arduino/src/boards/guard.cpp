#ifdef ARDUINO

#include "guard.h"

#include <Arduino.h>
#include <avr/wdt.h>

#include "../vm/crc32.h"
#include "motors.h"

namespace tiniscript {

namespace {

constexpr uint8_t kStallMs = 100;
constexpr uint16_t kNoiseBytes = 64;
constexpr uint8_t kRestarted = 0x5a;

volatile uint8_t silent_ms;
volatile bool has_stalled;

// What lies here outlives a restart.
uint8_t flags __attribute__((section(".noinit")));      // MCUSR after the reset
uint8_t restarted __attribute__((section(".noinit")));  // kRestarted: by the watchdog's jump

}  // namespace

// The watchdog may still run, and shortly: it is put off before memory is set up. There is no
// stack frame yet, and `main` follows behind: so it is naked, and nobody calls it.
extern "C" void tiniscript_guard_off() __attribute__((naked, used, section(".init3")));
void tiniscript_guard_off() {
  flags = MCUSR;
  MCUSR = 0;
  WDTCSR = 1 << WDCE | 1 << WDE;
  WDTCSR = 0;
}

void guard_begin() {
  const uint8_t before = SREG;
  cli();
  TIMSK0 |= 1 << OCIE0A;  // once in each turn of timer 0, about a millisecond
  wdt_reset();
  WDTCSR = 1 << WDCE | 1 << WDE;
  // 0.25 s, and the second time-out resets. An old Nano's bootloader cannot turn that off again:
  // if the program has hung with interrupts off, its motors stay off until it has no power.
  WDTCSR = 1 << WDIE | 1 << WDE | 1 << WDP2;
  SREG = before;
}

void guard_calm() {
  wdt_reset();
  silent_ms = 0;
}

bool guard_has_stalled() {
  const bool found = has_stalled;
  has_stalled = false;
  return found;
}

Reset guard_reset() {
  const bool has_jumped = restarted == kRestarted;
  restarted = 0;
  if (has_jumped || (flags & 1 << WDRF) != 0) return Reset::kWatchdog;
  if ((flags & 1 << PORF) != 0) return Reset::kPower;
  if ((flags & 1 << BORF) != 0) return Reset::kBrownOut;
  if ((flags & 1 << EXTRF) != 0) return Reset::kButton;
  return Reset::kUnknown;  // a bootloader has looked first
}

uint32_t guard_noise() {
  const uint8_t* const end = reinterpret_cast<const uint8_t*>(RAMEND + 1);
  const uint8_t* const stack = reinterpret_cast<const uint8_t*>(SP);
  const uint8_t* const from = stack - 4 * kNoiseBytes;
  return crc32(crc32(0, from, kNoiseBytes), stack, static_cast<uint16_t>(end - stack - 1));
}

}  // namespace tiniscript

ISR(TIMER0_COMPA_vect) {
  using namespace tiniscript;
  const uint8_t silent = static_cast<uint8_t>(silent_ms + 1);
  if (silent <= kStallMs) {
    silent_ms = silent;
    return;
  }
  has_stalled = true;
  motors_stop();
}

// Nobody has answered for 0.25 s. Interrupts are off here.
ISR(WDT_vect) {
  using namespace tiniscript;
  motors_stop();
#ifdef ARDUINO_AVR_UNO
  for (;;) {  // the reset comes
  }
#else
  restarted = kRestarted;
  WDTCSR = 1 << WDCE | 1 << WDE;
  WDTCSR = 0;
  asm volatile("jmp 0");
#endif
}

#endif  // ARDUINO
