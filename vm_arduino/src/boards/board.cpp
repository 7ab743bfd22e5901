// Implements `board.h` and `robot.h`: the board as the sketch and the machine see it.
//
// The robot's header defines each sensor and actuator.

#include "board.h"

#include "../firmware/readings.h"
#include "../firmware/remote.h"
#include "../robot.h"
#include "../text/kit_words.h"
#include "analog.h"
#include "chip.h"
#include "discs.h"
#include "kit.h"
#include "motors.h"
#include "servo.h"
#include "sound.h"
#include "uart.h"
#include "ultrasonic.h"

namespace tiniscript {

namespace {

constexpr uint16_t kSteadyUs = 50000;  // a change of the STATE pin counts after this time

bool is_connected;
uint16_t agreed_us;  // when the STATE pin last agreed with `is_connected`
uint8_t seen_ms;     // lowest bits of the clock at the last look
constexpr uint8_t kReadings = readings_of(kBoardSensors);
int32_t readings[kReadings == 0 ? 1 : kReadings];  // C++ has no empty array

// `sensors` is a parameter as no uint8_t can be less than a constant 0.
constexpr bool is_of_kit(uint8_t sensor, uint8_t sensors = kBoardSensors) { return sensor < sensors; }

}  // namespace

void board_begin() {
  begin_pull_up(kStartButton);
  if (is_there(kBluetoothState)) begin_pull_up(kBluetoothState);  // the pin may be unconnected
  if (is_there(kLight)) begin_output(kLight, false);
  begin_devices();
  analog_begin();
  sound_begin();
  ultrasonic_begin();
  discs_begin();
#ifdef tiniscript_servos
  servo_begin();
#endif
  watchdog_begin();
}

uint32_t board_now_ms() { return clock_ms(); }

bool board_has_news() {
  const uint8_t time_ms = clock_8_ms();
  if (time_ms == seen_ms && !button_has_moved(!is_high(kStartButton))) return false;
  seen_ms = time_ms;
  return true;
}

void board_tick(uint32_t now_ms) {
  watchdog_feed();
  analog_tick();
  ultrasonic_tick();
  sound_tick(now_ms);
  discs_tick();
#ifdef tiniscript_servos
  servo_tick(now_ms);
#endif
}

bool board_has_disconnected() {
  if (!is_there(kBluetoothState)) return false;
  const uint16_t now_us = clock_us();
  const bool is_state_high = is_high(kBluetoothState);
  if (is_state_high == is_connected) agreed_us = now_us;
  if (static_cast<uint16_t>(now_us - agreed_us) < kSteadyUs) return false;
  agreed_us = now_us;
  is_connected = is_state_high;
  return !is_state_high;
}

BootInfo board_boot_info() {
  BootInfo info;
  info.reset = watchdog_reset_cause();
  info.seed = watchdog_seed() ^ clock_us();
  return info;
}

uint16_t board_kit() { return kBoardKit; }

uint8_t board_sensors() { return kBoardSensors; }

uint8_t board_actuators() { return kBoardActuators; }

int32_t* board_readings() { return readings; }

uint32_t board_max_run_ms() { return uint32_t{kMaxRunSeconds} * 1000; }

uint32_t board_speed(bool is_turn) { return is_turn ? kBoardTurn : kBoardSpeed; }

uint16_t robot_device_hash(uint16_t device) { return flash_word(kDeviceHashes + device); }

const uint8_t* robot_words() { return kKitWords; }

// A profile's `language` defines it, or -D tiniscript_language=0x6573.
uint16_t robot_language() {
#ifdef tiniscript_language
  return tiniscript_language;
#else
  return 0;
#endif
}

void board_stop() { motors_stop(); }

void board_release() { motors_release(); }

void board_actuators_off() { actuators_off(false); }

// A program may have set an actuator again after the timer turned it off.
bool board_take_stall() {
  const bool has_stalled = watchdog_take_stall();
  if (has_stalled) actuators_off(true);
  return has_stalled;
}

bool board_take_hang(Place* place) { return watchdog_take_hang(place); }

Press board_button(uint32_t now_ms) { return button_read(!is_high(kStartButton), now_ms); }

LineErrors board_line_errors() { return uart_errors(); }

void board_forget() {
  analog_forget();
  ultrasonic_forget();
}

Supply board_supply() { return analog_supply(); }

void board_light(bool is_on) {
  if (is_there(kLight)) write(kLight, is_on);
}

void board_finished() { sound_finished(); }

void board_faulted() { sound_faulted(); }

void board_steer(int16_t left, int16_t right) { board_motors(left, right); }

void robot_off() {
  board_motors(0, 0);
  sound_off();
}

bool robot_read(uint8_t sensor, int32_t* value) {
  const int32_t previous_value = *value;
  if (!kHasRemote || is_of_kit(sensor)) {
    return read_sensor(sensor, value) && note_reading(sensor, previous_value, *value);
  }
  *value = remote_reading(static_cast<uint8_t>(sensor - kBoardSensors));
  return note_reading(sensor, previous_value, *value);
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) { sound_start(hertz, duration_ms); }

// A program that is being stopped must not set anything.
void robot_set(uint8_t actuator, int32_t value) {
  if (!motors_are_stopped()) set_actuator(actuator, value);
}

}  // namespace tiniscript
