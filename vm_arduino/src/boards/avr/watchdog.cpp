#ifdef __AVR__

#include "watchdog.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "../../firmware/firmware.h"
#include "../../vm/crc32.h"
#include "../../vm/small.h"
#include "interrupts.h"
#include "../kit.h"
#include "../motors.h"
#include "../servo.h"

namespace tiniscript {

namespace {

constexpr uint16_t kNoiseBytes = 256;    // below the stack
constexpr uint32_t kAlive = 0x6f3a91c4;  // value of `mark` in normal operation
constexpr uint32_t kHung = 0x93c5e21b;   // value of `mark` after a hang, when the record counts

static_assert(static_cast<uint8_t>(Reset::kPower) == PORF + 1 &&
                  static_cast<uint8_t>(Reset::kButton) == EXTRF + 1 &&
                  static_cast<uint8_t>(Reset::kBrownOut) == BORF + 1 &&
                  static_cast<uint8_t>(Reset::kWatchdog) == WDRF + 1,
              "a cause is the number of its flag in MCUSR, from 1 on");

volatile bool has_stalled;
bool has_hung;  // before the last reset; not yet reported

// Survives a restart. After power-on its contents are random: `mark` says whether it counts.
struct Record {
  uint32_t mark;
  Place place;  // zeros if no program ran
};

Record hang_record __attribute__((section(".noinit")));
uint16_t resets __attribute__((section(".noinit")));  // count of resets, from a random start
uint8_t flags __attribute__((section(".noinit")));    // MCUSR after the reset

// The interrupt of timer 0.
void on_stall() {
  TIMSK0 &= static_cast<uint8_t>(~(1 << OCIE0A));
  clock.silence_ms = 0;
  has_stalled = true;
  motors_stop();
  actuators_off(true);
}

void mark_alive() { hang_record.mark = kAlive; }

tini_noinline uint32_t hang_mark() {
  return kHung ^ hang_record.place.checksum ^ hang_record.place.offset;
}

}  // namespace

// Records the code that the watchdog interrupts.
extern "C" void tiniscript_note_hang() __attribute__((used, noinline));
void tiniscript_note_hang() {
  if (hang_record.mark != kAlive) return;
  if (!firmware_runs(&hang_record.place)) hang_record.place = Place();
  hang_record.mark = hang_mark();
}

// Turns the watchdog off before memory is set up, because it may still run with a short timeout.
// After a hang with interrupts off, the state of that code is still intact here and is recorded.
// Naked because there is no stack frame yet; `main` follows, so it is never called.
extern "C" void tiniscript_watchdog_off() __attribute__((naked, used, section(".init3")));
void tiniscript_watchdog_off() {
  flags = MCUSR;
  MCUSR = 0;
  WDTCSR = 1 << WDCE | 1 << WDE;
  WDTCSR = 0;
  if (flags == 1 << WDRF) tiniscript_note_hang();
}

void watchdog_begin() {
  if (hang_record.mark == hang_mark()) {
    has_hung = true;
  } else {
    mark_alive();
  }
  const uint8_t saved_sreg = SREG;
  cli();
  wdt_reset();
  WDTCSR = 1 << WDCE | 1 << WDE;
  // 0.125 s; the second timeout resets. An old Nano's bootloader cannot disable the watchdog: after
  // a hang with interrupts off, the motors stay off until the power is cycled.
  WDTCSR = 1 << WDIE | 1 << WDE | 1 << WDP1 | 1 << WDP0;
  SREG = saved_sreg;
}

bool watchdog_take_stall() {
  const bool had_stalled = has_stalled;
  has_stalled = false;
  return had_stalled;
}

bool watchdog_take_hang(Place* place) {
  if (!has_hung) return false;
  has_hung = false;
  *place = hang_record.place;
  mark_alive();
  return true;
}

Reset watchdog_reset_cause() {
  uint8_t reset_flags = flags & (1 << WDRF | 1 << PORF | 1 << BORF | 1 << EXTRF);
  if (has_hung) reset_flags = 1 << WDRF;
  if ((reset_flags & 1 << WDRF) == 0 && (reset_flags & 1 << PORF) != 0) reset_flags = 1 << PORF;
  uint8_t cause = 0;  // unknown: a bootloader has cleared the flags
  for (; reset_flags != 0; reset_flags >>= 1) cause++;
  return static_cast<Reset>(cause);
}

uint32_t watchdog_seed() {
  const uint8_t* const end = reinterpret_cast<const uint8_t*>(RAMEND + 1);
  const uint8_t* const stack = reinterpret_cast<const uint8_t*>(SP);
  const uint8_t* const start = stack - kNoiseBytes;
  return crc32(++resets, start, static_cast<uint16_t>(end - start - 1));
}

}  // namespace tiniscript

tiniscript_interrupt(TIMER0_COMPA_vect, tiniscript::on_stall)

    // The main loop has not fed the watchdog for 0.125 s. Interrupts are off here. It never
    // returns, so it saves no registers.
    ISR(WDT_vect, ISR_NAKED) {
  using namespace tiniscript;
  asm volatile("clr __zero_reg__");
  motors_stop();
  actuators_off(true);
#ifdef tiniscript_servos
  servos_low();
#endif
  tiniscript_note_hang();
#ifdef ARDUINO_AVR_UNO
  for (;;) {  // until the reset
  }
#else
  WDTCSR = 1 << WDCE | 1 << WDE;
  WDTCSR = 0;
  asm volatile("jmp 0");
  __builtin_unreachable();
#endif
}

#endif  // __AVR__
