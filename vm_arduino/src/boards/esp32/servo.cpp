#ifdef ARDUINO_ARCH_ESP32

#include "../servo.h"

#include "../kit.h"

#ifdef tiniscript_servos

namespace tiniscript {

namespace {

constexpr uint8_t kServoCount = sizeof kServos / sizeof *kServos;
constexpr uint32_t kServoHertz = 50;
constexpr uint8_t kServoBits = 14;
constexpr uint32_t kFrameUs = 20000;
constexpr uint8_t kFrameMs = 20;

struct Pulse {
  uint16_t us;  // 0: no pulse
  bool is_held;
  uint32_t end_ms;  // when it ends, unless it is held
};

Pulse pulses[kServoCount];  // any task changes them, in a critical section

// The new pulse begins with the next frame, so no pulse is cut.
void pulse(uint8_t number, uint16_t us) {
  pulses[number].us = us;
  write_duty(kServos[number], ((uint32_t{us} << kServoBits) + kFrameUs / 2) / kFrameUs);
}

}  // namespace

void servo_begin() {
  for (const Pwm& servo : kServos) {
    begin_channel(servo, kServoHertz, kServoBits);
    join(servo);  // at duty 0: it stays low
  }
}

void servo_set(uint8_t number, uint16_t pulse_us, uint8_t frames) {
  const CriticalSection critical;
  pulse(number, pulse_us);
  pulses[number].is_held = pulse_us != 0 && frames == 0;
  pulses[number].end_ms = clock_ms() + static_cast<uint32_t>(frames) * kFrameMs;
}

bool servo_is_held(uint8_t number) {
  const CriticalSection critical;
  return pulses[number].is_held;
}

void servo_tick(uint32_t now_ms) {
  for (uint8_t number = 0; number < kServoCount; number++) {
    const CriticalSection critical;
    const Pulse& current = pulses[number];
    if (current.us == 0 || current.is_held) continue;
    if (static_cast<int32_t>(now_ms - current.end_ms) >= 0) pulse(number, 0);
  }
}

}  // namespace tiniscript

#endif

#endif  // ARDUINO_ARCH_ESP32
