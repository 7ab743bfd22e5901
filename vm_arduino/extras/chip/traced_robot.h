// A robot that only records what it does, as the lines of `tsc run`, in memory of fixed size.
//
// Defines what `robot.h` declares. Readings come from lists: each takes the next value, the last
// one repeats, no list is 0. Names and readings stay in the request.

#pragma once

#include "request.h"

namespace tiniscript {

#ifdef __AVR__
constexpr uint8_t kMaxSensors = 14;
constexpr uint8_t kMaxActuators = 4;
#else  // more than a profile may have
constexpr uint8_t kMaxSensors = 255;
constexpr uint8_t kMaxActuators = 255;
#endif

// When a machine is called: at multiples of so many milliseconds. Some sensors, bits of their
// numbers, are slow: not ready from one time to another in each period.
struct Pace {
  uint32_t call_interval_ms;
  uint32_t slow_sensors;
  uint32_t period_ms;
  uint32_t from_ms;
  uint32_t to_ms;
};

constexpr Pace kAtOnce = {1, 0, 1, 0, 0};

struct TracedRobot {
  struct Sensor {
    size_t name;      // where it begins in the request
    size_t readings;  // where they begin
    uint16_t count;
    uint16_t next_reading;
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

  unsigned long now_ms;  // on Linux and macOS it does not wrap around
  uint32_t not_ready;  // every so many questions the robot is not ready; 0: always ready
  uint32_t questions;
  Pace pace;
  uint32_t speed;
  uint32_t turn;
  bool has_tasks;  // each of them asks by itself
  bool must_wait;  // it was not ready, and this tick should be over
  bool was_slow;   // in this call
  bool is_off;     // and no motor was set since
  uint8_t sensor_count;
  uint8_t actuator_count;
  Sensor sensors[kMaxSensors];
  Actuator actuators[kMaxActuators];

  // Takes sensors, readings and actuators from a request and starts at 0 ms. False: there are more
  // than fit.
  bool read(Request* request);

  // Whether it reads, or shows, what it is asked now.
  bool is_ready();
  bool is_slow(uint8_t sensor);

  // Begins a line of the trace; the caller adds the rest.
  void say(const char* word) const;
};

// The one robot of this program.
extern TracedRobot robot;

}  // namespace tiniscript
