// The board as the sketch and the machine see it: what `board.h` and `robot.h` ask for.
//
// What a sensor or an actuator is, the robot's header says.

#include "board.h"

#include <Arduino.h>

#include "../robot.h"
#include "analog.h"
#include "echo.h"
#include "kit.h"
#include "motors.h"
#include "servo.h"
#include "sound.h"
#include "uart.h"
#include "watchdog.h"

namespace tiniscript {

namespace {

constexpr uint16_t kSteadyUs = 50000;  // a change of the STATE pin counts then

bool is_connected;
uint32_t agreed_us;  // when the STATE pin said last what `is_connected` says
int32_t readings[kBoardSensors];

}  // namespace

void board_begin() {
  begin_pull_up(kStartButton);
  if (kBluetoothState.port != 0) begin_pull_up(kBluetoothState);  // it may hang in the air
  if (kLight.port != 0) begin_output(kLight, false);
  begin_devices();
  sound_begin();
#ifdef tiniscript_servos
  servo_begin();
#endif
  watchdog_begin();
}

uint32_t board_now_ms() { return millis(); }

void board_tick(uint32_t now_ms) {
  watchdog_feed();
  analog_tick();
  sound_tick(now_ms);
}

bool board_has_disconnected() {
  if (kBluetoothState.port == 0) return false;
  const uint32_t now_us = micros();
  const bool is_now = is_high(kBluetoothState);
  if (is_now == is_connected) agreed_us = now_us;
  if (now_us - agreed_us < kSteadyUs) return false;
  agreed_us = now_us;
  is_connected = is_now;
  return !is_now;
}

Board board_told() {
  Board told;
  told.kit = kBoardKit;
  told.sensors = kBoardSensors;
  told.actuators = kBoardActuators;
  told.readings = readings;
  told.reset = watchdog_reset_cause();
  told.seed = watchdog_seed() ^ micros();
  told.max_run_ms = uint32_t{kMaxRunSeconds} * 1000;
  return told;
}

void board_stop() { motors_stop(); }

void board_release() { motors_release(); }

void board_actuators_off() { actuators_off(false); }

// What the timer has turned off may have been set once more since.
bool board_has_stalled() {
  const bool found = watchdog_has_stalled();
  if (found) actuators_off(true);
  return found;
}

bool board_has_hung(Place* place) { return watchdog_has_hung(place); }

Press board_button(uint32_t now_ms) { return button_read(!is_high(kStartButton), now_ms); }

LineErrors board_line_errors() { return uart_errors(); }

void board_forget() {
  analog_forget();
  echo_forget();
}

Supply board_supply() { return analog_supply(); }

void board_light(bool is_on) {
  if (kLight.port != 0) write(kLight, is_on);
}

void board_finished() { sound_finished(millis()); }

void board_faulted() { sound_faulted(millis()); }

void robot_off() {
  board_motors(0, 0);
  sound_off();
}

bool robot_read(uint8_t sensor, int32_t* value) { return read_sensor(sensor, value); }

void robot_beep(uint16_t hertz, uint32_t duration_ms) { sound_start(hertz, duration_ms, millis()); }

// A program that is being stopped sets nothing any more.
void robot_set(uint8_t actuator, int32_t value) {
  if (!motors_are_stopped()) set_actuator(actuator, value);
}

}  // namespace tiniscript
