// The board as the sketch and the machine see it: what `board.h` and `robot.h` ask for.
//
// What a sensor or an actuator is, the robot's header says. There is no link yet: what a program
// shows goes nowhere.

#include "board.h"

#include <Arduino.h>

#include "../robot.h"
#include "analog.h"
#include "echo.h"
#include "kit.h"
#include "motors.h"
#include "servo.h"
#include "sound.h"

namespace tiniscript {

void board_begin() {
  begin_pull_up(kStartButton);
  if (kLight.port != 0) begin_output(kLight, false);
  begin_devices();
  sound_begin();
#ifdef tiniscript_servos
  servo_begin();
#endif
}

uint32_t board_now_ms() { return millis(); }

void board_tick(uint32_t now_ms) { sound_tick(now_ms); }

Press board_button(uint32_t now_ms) { return button_read(!is_high(kStartButton), now_ms); }

void board_forget() {
  analog_forget();
  echo_forget();
}

void board_light(bool is_on) {
  if (kLight.port != 0) write(kLight, is_on);
}

void board_finished() { sound_finished(millis()); }

void robot_off() {
  robot_motors(0, 0);
  sound_off();
}

bool robot_read(uint8_t sensor, int32_t* value) { return read_sensor(sensor, value); }

void robot_beep(uint16_t hertz, uint32_t duration_ms) { sound_start(hertz, duration_ms, millis()); }

bool robot_show(int32_t, bool) { return true; }

void robot_set(uint8_t actuator, int32_t value) { set_actuator(actuator, value); }

}  // namespace tiniscript
