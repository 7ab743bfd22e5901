// The board as the sketch and the machine see it: what `board.h` and `robot.h` ask for.
//
// What a sensor or an actuator is, the robot's header says.

#include "board.h"

#include <Arduino.h>

#include "../robot.h"
#include "analog.h"
#include "echo.h"
#include "guard.h"
#include "kit.h"
#include "motors.h"
#include "servo.h"
#include "sound.h"
#include "uart.h"

namespace tiniscript {

namespace {

bool was_connected;
int32_t readings[kBoardSensors];

}  // namespace

void board_begin() {
  begin_pull_up(kStartButton);
  if (kLight.port != 0) begin_output(kLight, false);
  begin_devices();
  sound_begin();
#ifdef tiniscript_servos
  servo_begin();
#endif
  guard_begin();
}

uint32_t board_now_ms() { return millis(); }

void board_tick(uint32_t now_ms) {
  guard_calm();
  analog_tick();
  sound_tick(now_ms);
}

bool board_is_left() {
  if (kBluetoothState.port == 0) return false;
  const bool is_connected = is_high(kBluetoothState);
  const bool is_left = was_connected && !is_connected;
  was_connected = is_connected;
  return is_left;
}

Board board_told() {
  Board told;
  told.kit = kBoardKit;
  told.sensors = kBoardSensors;
  told.actuators = kBoardActuators;
  told.readings = readings;
  told.reset = guard_reset();
  told.chance = guard_noise() ^ micros();
  told.max_run_ms = uint32_t{kMaxRunSeconds} * 1000;
  return told;
}

void board_stop() { motors_stop(); }

void board_release() { motors_release(); }

bool board_has_stalled() { return guard_has_stalled(); }

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

void robot_set(uint8_t actuator, int32_t value) { set_actuator(actuator, value); }

}  // namespace tiniscript
