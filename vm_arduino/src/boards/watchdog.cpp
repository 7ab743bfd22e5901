#ifdef ARDUINO

#include "watchdog.h"

#include <Arduino.h>
#include <avr/wdt.h>

#include "../firmware/firmware.h"
#include "../vm/crc32.h"
#include "kit.h"
#include "motors.h"
#include "servo.h"

namespace tiniscript {

namespace {

constexpr uint8_t kStallMs = 100;
constexpr uint16_t kNoiseBytes = 64;
constexpr uint32_t kAlive = 0x6f3a91c4;  // what `mark` is while the robot goes on
constexpr uint32_t kHung = 0x93c5e21b;   // and, with the rest of the record, after a hang

volatile uint8_t silent_ms;
volatile bool has_stalled;
bool has_hung;  // before the last reset, and nobody has asked

// What lies here outlives a restart. Without power it is anything: `mark` says whether it counts.
struct Record {
  uint32_t mark;
  Place place;  // zeros where nothing ran
};

Record last __attribute__((section(".noinit")));
uint32_t resets __attribute__((section(".noinit")));  // counts them, from anywhere
uint8_t flags __attribute__((section(".noinit")));    // MCUSR after the reset

uint32_t hung_mark() { return kHung ^ last.place.program ^ last.place.at; }

}  // namespace

// Notes what the watchdog ends.
extern "C" void tiniscript_note_hang() __attribute__((used, noinline));
void tiniscript_note_hang() {
  if (last.mark != kAlive) return;
  if (!firmware_runs(&last.place)) last.place = Place();
  last.mark = hung_mark();
}

// The watchdog may still run, and shortly: it is put off before memory is set up. So what ran is
// still there too, where a hang with interrupts off has been reset without being noted. There is no
// stack frame yet, and `main` follows behind: so it is naked, and nobody calls it.
extern "C" void tiniscript_watchdog_off() __attribute__((naked, used, section(".init3")));
void tiniscript_watchdog_off() {
  flags = MCUSR;
  MCUSR = 0;
  WDTCSR = 1 << WDCE | 1 << WDE;
  WDTCSR = 0;
  if (flags == 1 << WDRF) tiniscript_note_hang();
}

void watchdog_begin() {
  has_hung = last.mark == hung_mark();
  last.mark = has_hung ? last.mark : kAlive;
  const uint8_t before = SREG;
  cli();
  TIMSK0 |= 1 << OCIE0A;  // once in each turn of timer 0, about a millisecond
  wdt_reset();
  WDTCSR = 1 << WDCE | 1 << WDE;
  // 0.125 s, and the second time-out resets. An old Nano's bootloader cannot turn that off again:
  // if the program has hung with interrupts off, its motors stay off until it has no power.
  WDTCSR = 1 << WDIE | 1 << WDE | 1 << WDP1 | 1 << WDP0;
  SREG = before;
}

void watchdog_feed() {
  wdt_reset();
  silent_ms = 0;
}

bool watchdog_has_stalled() {
  const bool found = has_stalled;
  has_stalled = false;
  return found;
}

bool watchdog_has_hung(Place* place) {
  if (!has_hung) return false;
  has_hung = false;
  *place = last.place;
  last.mark = kAlive;
  return true;
}

Reset watchdog_reset_cause() {
  if (has_hung || (flags & 1 << WDRF) != 0) return Reset::kWatchdog;
  if ((flags & 1 << PORF) != 0) return Reset::kPower;
  if ((flags & 1 << BORF) != 0) return Reset::kBrownOut;
  if ((flags & 1 << EXTRF) != 0) return Reset::kButton;
  return Reset::kUnknown;  // a bootloader has looked first
}

uint32_t watchdog_seed() {
  const uint8_t* const end = reinterpret_cast<const uint8_t*>(RAMEND + 1);
  const uint8_t* const stack = reinterpret_cast<const uint8_t*>(SP);
  const uint8_t* const from = stack - 4 * kNoiseBytes;
  const uint32_t found =
      crc32(crc32(0, from, kNoiseBytes), stack, static_cast<uint16_t>(end - stack - 1));
  resets++;
  return crc32(found, reinterpret_cast<const uint8_t*>(&resets), sizeof resets);
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
  actuators_off(true);
}

// Nobody has answered for 0.125 s. Interrupts are off here.
ISR(WDT_vect) {
  using namespace tiniscript;
  motors_stop();
  actuators_off(true);
#ifdef tiniscript_servos
  servos_low();
#endif
  tiniscript_note_hang();
#ifdef ARDUINO_AVR_UNO
  for (;;) {  // the reset comes
  }
#else
  WDTCSR = 1 << WDCE | 1 << WDE;
  WDTCSR = 0;
  asm volatile("jmp 0");
#endif
}

#endif  // ARDUINO
