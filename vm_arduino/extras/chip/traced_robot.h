// A robot that only records what it does, in memory of fixed size.
//
// Defines what `robot.h` declares, and means the same as `../host/traced_robot.h`; its names and
// readings stay in the request.

#ifndef TINISCRIPT_CHIP_TRACED_ROBOT_H_
#define TINISCRIPT_CHIP_TRACED_ROBOT_H_

#include "request.h"

namespace tiniscript {

struct TracedRobot {
  struct Sensor {
    size_t name;      // where it begins in the request
    size_t readings;  // where they begin
    uint16_t count;
    uint16_t taken;
    uint16_t hash;
    bool is_yes_no;
  };
  struct Actuator {
    size_t name;
    int32_t low;
    int32_t high;
    uint16_t hash;
    bool is_yes_no;
  };

  uint32_t now_ms;
  uint32_t not_ready;  // every so many questions the robot is not ready; 0: always ready
  uint32_t asked;
  uint32_t speed;
  uint32_t turn;
  uint8_t sensor_count;
  uint8_t actuator_count;
  Sensor sensors[8];
  Actuator actuators[4];

  // Takes sensors, readings and actuators from a request and starts at 0 ms. False: there are more
  // than fit.
  bool read(Request* request);

  // Whether it reads, or shows, what it is asked now.
  bool is_ready();

  // Begins a line of the trace; the caller adds the rest.
  void say(const char* what) const;
};

// The one robot of this program.
extern TracedRobot robot;

}  // namespace tiniscript

#endif  // TINISCRIPT_CHIP_TRACED_ROBOT_H_
