#ifdef __AVR__

#include "../servo.h"

#include "../../vm/small.h"
#include "../kit.h"
#include "quick_stop.h"

#ifdef tiniscript_servos

namespace tiniscript {

namespace {

constexpr uint8_t kServoCount = sizeof kServos / sizeof *kServos;
constexpr uint8_t kTicksPerUs = 2;       // 16 MHz / 8
constexpr uint16_t kFrameTicks = 40000;  // 20 ms
constexpr uint8_t kSoonTicks = 20;       // a compare value that is nearer than this may be missed
constexpr uint8_t kLateTicks = kServoCount == 1 ? 5 : 9;  // how late the interrupt ends a pulse
constexpr uint8_t kGap = kServoCount;  // the time between the last pulse and the next frame

struct Pulse {
  uint16_t ticks;  // 0: no pulse
  uint8_t frames;  // pulses left, or 0
};

volatile Pulse pulses[kServoCount];
uint8_t turn = kGap;  // index of the servo whose pulse is under way

// With only one servo, the compiler knows which one.
tini_always_inline uint8_t current_servo() { return kServoCount == 1 ? 0 : turn; }

// Ends a pulse and starts the next one. In between a stop may come in, unless it changes pulses.
tini_always_inline void next_pulse() {
  if (turn == kGap) {
    TCNT1 = 0;
    turn = 0;
  } else {
    write(kServos[current_servo()], false);
    turn++;
  }
#ifdef tiniscript_has_quick_stop
  sei();
#endif
  for (; turn < kServoCount; turn++) {
    volatile Pulse& pulse = pulses[current_servo()];
    const uint16_t ticks = pulse.ticks;
    if (ticks == 0) continue;
    if (pulse.frames != 0 && --pulse.frames == 0) pulse.ticks = 0;
    cli();
    write(kServos[current_servo()], true);
    OCR1A = static_cast<uint16_t>(TCNT1 + ticks - kLateTicks);
    return;
  }
  cli();
  const uint16_t earliest = static_cast<uint16_t>(TCNT1 + kSoonTicks);
  OCR1A = earliest < kFrameTicks ? kFrameTicks : earliest;
}

}  // namespace

void servo_begin() {
  for (const Pin& pin : kServos) begin_output(pin, false);
  const CriticalSection critical;
  TCCR1A = 0;
  TCCR1B = 1 << CS11;
  TCNT1 = 0;
  OCR1A = kFrameTicks;
  TIFR1 = 1 << OCF1A;
  TIMSK1 = 1 << OCIE1A;
}

// Not inlined: otherwise the calculation of the pulse would move in between, where interrupts are
// off.
tini_noinline void servo_set(uint8_t number, uint16_t pulse_us, uint8_t frames) {
  const CriticalSection critical;
  pulses[number].ticks = static_cast<uint16_t>(pulse_us * kTicksPerUs);
  pulses[number].frames = frames;
}

void servos_low() {
  for (uint8_t number = 0; number < kServoCount; number++) {
    pulses[number].ticks = 0;
    write(kServos[number], false);
  }
}

bool servo_is_held(uint8_t number) {
  const CriticalSection critical;
  return pulses[number].ticks != 0 && pulses[number].frames == 0;
}

}  // namespace tiniscript

ISR(TIMER1_COMPA_vect) { tiniscript::next_pulse(); }

#endif

#endif  // __AVR__
