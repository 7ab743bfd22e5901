#include "traced_robot.h"

#include <stdlib.h>

#include "../../src/robot.h"
#include "../../src/vm/number.h"

TracedRobot robot;

namespace {

// The shortest decimal: `12.5`, `-0.001`, `7`.
std::string as_text(int64_t value) {
  const int64_t size = value < 0 ? -value : value;
  std::string text = (value < 0 ? "-" : "") + std::to_string(size / 1000);
  const std::string digits = std::to_string(1000 + size % 1000);  // keeps the zeros in front
  const size_t last = digits.find_last_not_of('0');
  return last == 0 ? text : text + "." + digits.substr(1, last);
}

std::string shown(int64_t value, bool is_yes_no) {
  return is_yes_no ? value != 0 ? "TRUE" : "FALSE" : as_text(value);
}

}  // namespace

void TracedRobot::say(const std::string& text) {
  trace += std::to_string(now_ms) + " " + text + "\n";
}

bool TracedRobot::is_ready() {
  if (must_wait && !has_tasks) say("ASKED AGAIN AT ONCE");
  must_wait = not_ready != 0 && ++asked % not_ready == 0;
  return !must_wait;
}

namespace tiniscript {

void robot_motors(int8_t left, int8_t right) {
  robot.is_off = false;
  robot.say("MOTORS " + std::to_string(left) + " " + std::to_string(right));
}

// The final stop is no line of a trace.
void robot_off() { robot.is_off = true; }

bool robot_read(uint8_t sensor, int32_t* value) {
  if (!robot.is_ready()) return false;
  const std::vector<int32_t>& values = robot.readings.at(sensor);
  const size_t next = robot.taken[sensor]++;
  *value = values.empty() ? 0 : values[next < values.size() ? next : values.size() - 1];
  const Device& device = robot.sensors[sensor];
  robot.say("READ " + device.name + " " + shown(*value, device.is_yes_no));
  return true;
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  robot.say("BEEP " + std::to_string(hertz) + " " + std::to_string(duration_ms));
}

bool robot_show(int32_t value, bool is_yes_no) {
  if (!robot.is_ready()) return false;
  robot.say("SHOW " + shown(value, is_yes_no));
  return true;
}

int32_t robot_speed(bool is_turn, uint8_t power) {
  return static_cast<int32_t>((is_turn ? robot.turn : robot.speed) * power);
}

uint16_t robot_device_hash(uint16_t device) {
  if (device < robot.sensors.size()) return robot.sensors[device].hash;
  const size_t number = device - robot.sensors.size();
  return number < robot.actuators.size() ? robot.actuators[number].hash : 0;  // none is asked about
}

void robot_set(uint8_t actuator, int32_t value) {
  if (actuator >= robot.actuators.size()) return;  // the code was not verified
  const Device& device = robot.actuators[actuator];
  int64_t set = value;
  if (!device.is_yes_no) {
    set = static_cast<int64_t>(whole(value)) * kOne;
    if (set < device.low) set = device.low;
    if (set > device.high) set = device.high;
  }
  robot.say("SET " + device.name + " " + shown(set, device.is_yes_no));
}

}  // namespace tiniscript
