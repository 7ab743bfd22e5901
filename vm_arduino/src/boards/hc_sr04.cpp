#include "hc_sr04.h"

#include <Arduino.h>

namespace tiniscript {

namespace {

constexpr uint8_t kTriggerUs = 10;   // how long the trigger is high, at least
constexpr uint16_t kEchoUs = 30000;  // there and back is at most 23.3 ms, and 0.5 ms to begin
constexpr int32_t kFarthest = 400000;
constexpr uint8_t kThousandthsPerUs = 17;  // half of 34.3 cm a millisecond, rounded

enum class Ping : uint8_t { kNone, kTriggered, kListening };

uint8_t trigger;
uint8_t echo;
Ping ping = Ping::kNone;
uint32_t begun_us;

// What the interrupt notes: when the echo began, and how long it was.
volatile uint32_t rose_us;
volatile uint32_t echo_us;
volatile bool has_echo;

void on_echo() {
  if (digitalRead(echo) == HIGH) {
    rose_us = micros();
  } else {
    echo_us = micros() - rose_us;
    has_echo = true;
  }
}

}  // namespace

void hc_sr04_begin(uint8_t trigger_pin, uint8_t echo_pin) {
  trigger = trigger_pin;
  echo = echo_pin;
  pinMode(trigger, OUTPUT);
  pinMode(echo, INPUT);
  attachInterrupt(digitalPinToInterrupt(echo), on_echo, CHANGE);
}

bool hc_sr04_read(int32_t* distance) {
  const uint32_t gone_us = micros() - begun_us;
  if (ping == Ping::kNone) {
    digitalWrite(trigger, HIGH);
    begun_us = micros();
    ping = Ping::kTriggered;
  } else if (ping == Ping::kTriggered) {
    if (gone_us < kTriggerUs) return false;
    has_echo = false;
    digitalWrite(trigger, LOW);
    begun_us = micros();
    ping = Ping::kListening;
  } else {
    const bool is_heard = has_echo;  // from then on `echo_us` stays as it is
    if (!is_heard && gone_us < kEchoUs) return false;
    ping = Ping::kNone;
    *distance = kFarthest;
    if (is_heard && echo_us < kEchoUs) {
      *distance = static_cast<int32_t>(echo_us) * kThousandthsPerUs;
      if (*distance > kFarthest) *distance = kFarthest;
    }
    return true;
  }
  return false;
}

}  // namespace tiniscript
