#include "traced_robot.h"

#include "../../src/robot.h"
#include "../../src/vm/number.h"
#include "text.h"

namespace tiniscript {

TracedRobot robot;

namespace {

// Adds the name of a device and what it reads or is set to, and ends the line.
void put_device(size_t name, int32_t value, bool is_yes_no) {
  Request letters(name);
  for (uint32_t remaining = letters.u32(); remaining != 0; remaining--)
    put(static_cast<char>(letters.u8()));
  put(' ');
  put_value(value, is_yes_no);
  put('\n');
}

}  // namespace

bool TracedRobot::read(Request* request) {
  now_ms = 0;
  must_wait = was_slow = is_off = false;
  sensor_count = request->u8();
  if (sensor_count > kMaxSensors) return false;
  for (uint8_t k = 0; k < sensor_count; k++) {
    Sensor& sensor = sensors[k];
    sensor.name = request->text();
    sensor.is_yes_no = request->u8() != 0;
    sensor.hash = request->u16();
    sensor.count = request->u16();
    sensor.next_reading = 0;
    sensor.readings = request->place();
    request->skip(sizeof(int32_t) * sensor.count);
  }
  actuator_count = request->u8();
  if (actuator_count > kMaxActuators) return false;
  for (uint8_t k = 0; k < actuator_count; k++) {
    Actuator& actuator = actuators[k];
    actuator.name = request->text();
    actuator.is_yes_no = request->u8() != 0;
    actuator.hash = request->u16();
    actuator.low = request->i32();
    actuator.high = request->i32();
  }
  speed = request->u32();
  turn = request->u32();
  not_ready = request->u32();
  questions = 0;
  pace = kAtOnce;
  return true;
}

bool TracedRobot::is_ready() {
  if (must_wait && !has_tasks) say("ASKED AGAIN AT ONCE\n");
  must_wait = not_ready != 0 && ++questions % not_ready == 0;
  return !must_wait;
}

bool TracedRobot::is_slow(uint8_t sensor) {
  if (sensor >= 32 || (pace.slow_sensors >> sensor & 1) == 0) return false;
  const uint32_t at_ms = static_cast<uint32_t>(now_ms) % pace.period_ms;
  const bool is_slow_now = pace.from_ms <= at_ms && at_ms < pace.to_ms;
  was_slow |= is_slow_now;
  return is_slow_now;
}

void TracedRobot::say(const char* word) const {
  put_size(now_ms);
  put(' ');
  put_text(word);
}

void robot_motors(int8_t left, int8_t right) {
  robot.is_off = false;
  robot.say("MOTORS ");
  put_number(left);
  put(' ');
  put_number(right);
  put('\n');
}

// The final stop is no line of a trace.
void robot_off() { robot.is_off = true; }

bool robot_read(uint8_t sensor, int32_t* value) {
  if (!robot.is_ready() || robot.is_slow(sensor)) return false;
  TracedRobot::Sensor& device = robot.sensors[sensor];
  const uint16_t last_index = static_cast<uint16_t>(device.count - 1);
  const uint16_t index = device.next_reading < last_index ? device.next_reading : last_index;
  device.next_reading++;
  *value = device.count == 0 ? 0 : Request(device.readings + sizeof(int32_t) * index).i32();
  robot.say("READ ");
  put_device(device.name, *value, device.is_yes_no);
  return true;
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  robot.say("BEEP ");
  put_size(hertz);
  put(' ');
  put_size(duration_ms);
  put('\n');
}

bool robot_show(int32_t value, bool is_yes_no) {
  if (!robot.is_ready()) return false;
  robot.say("SHOW ");
  put_value(value, is_yes_no);
  put('\n');
  return true;
}

int32_t robot_speed(bool is_turn, uint8_t power) {
  return static_cast<int32_t>((is_turn ? robot.turn : robot.speed) * power);
}

uint16_t robot_device_hash(uint16_t device) {
  if (device < robot.sensor_count) return robot.sensors[device].hash;
  device = static_cast<uint16_t>(device - robot.sensor_count);
  return device < robot.actuator_count ? robot.actuators[device].hash : 0;  // none is asked about
}

void robot_set(uint8_t actuator, int32_t value) {
  if (actuator >= robot.actuator_count) return;  // the code was not verified
  const TracedRobot::Actuator& device = robot.actuators[actuator];
  if (!device.is_yes_no) {
    // its limits are whole units, and within them a product has 32 bits
    const int32_t units = whole(value);
    value = units <= device.low / kOne    ? device.low
            : units >= device.high / kOne ? device.high
                                          : units * kOne;
  }
  robot.say("SET ");
  put_device(device.name, value, device.is_yes_no);
}

}  // namespace tiniscript
