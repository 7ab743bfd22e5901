// The paper's robot on an Uno, a Nano or a Mega: what `robot.h` and `board.h` ask for, with pins.
//
// An L298N drives the motors. The order of the sensors and the pins are those of the profile
// `tinibot`. There is no link yet: what a program shows goes nowhere.

#include <Arduino.h>

#include "../robot.h"
#include "board.h"
#include "hc_sr04.h"

namespace tiniscript {

namespace {

struct Motor {
  uint8_t pwm;
  uint8_t forward;
  uint8_t backward;
};

constexpr Motor kLeft = {5, 7, 8};
constexpr Motor kRight = {6, 9, 10};
constexpr uint8_t kButton = 2;
constexpr uint8_t kEcho = 3;
constexpr uint8_t kTrigger = 4;
constexpr uint8_t kBuzzer = 11;
constexpr uint8_t kLight = 13;
constexpr uint8_t kBounceMs = 30;  // for so long a contact may chatter

void begin(const Motor& motor) {
  const uint8_t pins[] = {motor.pwm, motor.forward, motor.backward};
  for (const uint8_t pin : pins) {
    digitalWrite(pin, LOW);
    pinMode(pin, OUTPUT);
  }
}

void drive(const Motor& motor, int8_t power) {
  const uint8_t size = static_cast<uint8_t>(power < 0 ? -power : power);
  digitalWrite(motor.forward, power > 0 ? HIGH : LOW);
  digitalWrite(motor.backward, power < 0 ? HIGH : LOW);
  analogWrite(motor.pwm, size * 255 / 100);
}

}  // namespace

void board_begin() {
  begin(kLeft);
  begin(kRight);
  pinMode(kButton, INPUT_PULLUP);
  pinMode(kLight, OUTPUT);
  hc_sr04_begin(kTrigger, kEcho);
}

uint32_t board_now_ms() { return millis(); }

bool board_pressed() {
  static bool was_down = false;
  static uint32_t changed_ms = 0;
  const uint32_t now_ms = millis();
  const bool is_down = digitalRead(kButton) == LOW;
  if (is_down == was_down || now_ms - changed_ms < kBounceMs) return false;
  was_down = is_down;
  changed_ms = now_ms;
  return is_down;
}

void board_light(bool is_on) { digitalWrite(kLight, is_on ? HIGH : LOW); }

void robot_motors(int8_t left, int8_t right) {
  drive(kLeft, left);
  drive(kRight, right);
}

void robot_off() {
  robot_motors(0, 0);
  noTone(kBuzzer);
}

bool robot_read(uint8_t sensor, int32_t* value) {
  if (sensor == 2) return hc_sr04_read(value);
  *value = analogRead(sensor == 0 ? A0 : A1) * static_cast<int32_t>(1000);
  return true;
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  if (duration_ms != 0) tone(kBuzzer, hertz, duration_ms);  // 0 would be a sound without end
}

bool robot_show(int32_t, bool) { return true; }

// There is no actuator.
void robot_set(uint8_t, int32_t) {}

}  // namespace tiniscript
