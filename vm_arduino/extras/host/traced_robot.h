// A robot that only records what it does, as the lines of `tsc run`.
//
// Defines what `robot.h` declares. Readings come from lists: each takes the next value, the last
// one repeats, no list is 0. The same as `TracedRobot` and `Senses` in `run.py`.

#ifndef TINISCRIPT_HOST_TRACED_ROBOT_H_
#define TINISCRIPT_HOST_TRACED_ROBOT_H_

#include <stdint.h>

#include <string>
#include <vector>

// A sensor or an actuator; `low` and `high` are thousandths.
struct Device {
  std::string name;
  bool is_yes_no;
  int32_t low;
  int32_t high;
  uint16_t hash;
};

struct TracedRobot {
  std::vector<Device> sensors;
  std::vector<Device> actuators;
  std::vector<std::vector<int32_t>> readings;  // of each sensor
  std::vector<size_t> taken;                   // how many, of each sensor
  uint32_t speed = 0;  // thousandths of a centimetre in a second
  uint32_t turn = 0;   // of a degree
  uint64_t now_ms = 0;  // does not wrap around
  std::string trace;
  bool has_tasks = false;  // each of them asks by itself
  uint32_t not_ready = 0;  // every so many questions the robot is not ready; 0: always ready
  uint32_t asked = 0;
  bool must_wait = false;  // it was not ready, and this tick should be over
  bool is_off = false;     // and no motor was set since

  void say(const std::string& text);
  bool is_ready();
};

// The one robot of this program.
extern TracedRobot robot;

#endif  // TINISCRIPT_HOST_TRACED_ROBOT_H_
