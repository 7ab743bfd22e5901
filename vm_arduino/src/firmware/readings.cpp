#include "readings.h"

#include "../link/port.h"
#include "../robot.h"
#include "halting.h"
#include "run.h"
#include "state.h"

#ifdef tiniscript_tells_readings

namespace tiniscript {

bool are_readings_noted;

namespace {

constexpr uint8_t kMostReadings = 12;  // on a slow line they delay the end of a run by that much
constexpr uint8_t kSensorsOfKits = 32;
constexpr uint8_t kAll = kSensorsOfKits + kRemoteRoom;

// A bit for each sensor.
class Sensors {
 public:
  bool has(uint8_t sensor) const { return (bytes_[sensor / 8] & bit(sensor)) != 0; }
  void add(uint8_t sensor) { bytes_[sensor / 8] |= bit(sensor); }
  void remove(uint8_t sensor) { bytes_[sensor / 8] &= static_cast<uint8_t>(~bit(sensor)); }
  void clear() {
    for (uint8_t& byte : bytes_) byte = 0;
  }
  // The first one, or kAll.
  uint8_t first() const {
    uint8_t sensor = 0;
    while (sensor < kAll && !has(sensor)) sensor++;
    return sensor;
  }

 private:
  static uint8_t bit(uint8_t sensor) { return static_cast<uint8_t>(1 << sensor % 8); }

  uint8_t bytes_[(kAll + 7) / 8];
};

ToldReading noted[kMostReadings];
uint8_t oldest;
uint8_t count;
Sensors has_read;  // in this run
Sensors untold;    // there was no room

ToldReading reading_of(uint8_t sensor, int32_t value) {
  const uint32_t since_ms = machine_ms() - machine_of_run().task().started_ms;
  return {robot_status.run, sensor, value, static_cast<uint16_t>(since_ms)};
}

}  // namespace

void begin_readings() {
  oldest = count = 0;
  has_read.clear();
  untold.clear();
}

void note_changed(uint8_t sensor, int32_t before, int32_t value) {
  if (has_read.has(sensor) && value == before) return;
  has_read.add(sensor);
  if (untold.has(sensor)) return;
  if (count == kMostReadings) return untold.add(sensor);
  noted[(oldest + count++) % kMostReadings] = reading_of(sensor, value);
}

void port_tell_readings(bool is_on) {
  const bool were_noted = are_readings_noted;
  are_readings_noted = is_on || link.tells_readings();
  if (!were_noted) begin_readings();
}

bool port_has_reading() { return count != 0 || untold.first() != kAll; }

ToldReading port_next_reading() {
  if (count == 0) {
    const uint8_t sensor = untold.first();
    untold.remove(sensor);
    return reading_of(sensor | kUntold, board_readings()[sensor]);
  }
  const ToldReading& reading = noted[oldest];
  oldest = static_cast<uint8_t>((oldest + 1) % kMostReadings);
  count--;
  return reading;
}

}  // namespace tiniscript

#endif
