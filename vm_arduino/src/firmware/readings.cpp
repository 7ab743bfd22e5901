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

constexpr uint8_t kMaxReadings = 12;  // on a slow line they delay the end of a run by that much
constexpr uint8_t kSensorsOfKits = 32;
constexpr uint8_t kAllSensors = kSensorsOfKits + kRemoteRoom;

// A bit for each sensor.
class Sensors {
 public:
  bool has(uint8_t sensor) const { return (bytes_[sensor / 8] & bit(sensor)) != 0; }
  void add(uint8_t sensor) { bytes_[sensor / 8] |= bit(sensor); }
  void remove(uint8_t sensor) { bytes_[sensor / 8] &= static_cast<uint8_t>(~bit(sensor)); }
  void clear() {
    for (uint8_t& byte : bytes_) byte = 0;
  }
  // The first one, or kAllSensors.
  uint8_t first() const {
    uint8_t sensor = 0;
    while (sensor < kAllSensors && !has(sensor)) sensor++;
    return sensor;
  }

 private:
  static uint8_t bit(uint8_t sensor) { return static_cast<uint8_t>(1 << sensor % 8); }

  uint8_t bytes_[(kAllSensors + 7) / 8];
};

ReadingReport reports[kMaxReadings];
uint8_t oldest;
uint8_t count;
Sensors read_sensors;     // in this run
Sensors dropped_sensors;  // there was no room

ReadingReport reading_of(uint8_t sensor, int32_t value) {
  const uint32_t since_ms = machine_ms() - machine_of_run().task().started_ms;
  return {robot_status.run, sensor, value, static_cast<uint16_t>(since_ms)};
}

}  // namespace

void begin_readings() {
  oldest = count = 0;
  read_sensors.clear();
  dropped_sensors.clear();
}

void note_changed(uint8_t sensor, int32_t previous_value, int32_t value) {
  if (read_sensors.has(sensor) && value == previous_value) return;
  read_sensors.add(sensor);
  if (dropped_sensors.has(sensor)) return;
  if (count == kMaxReadings) return dropped_sensors.add(sensor);
  reports[(oldest + count++) % kMaxReadings] = reading_of(sensor, value);
}

void port_tell_readings(bool is_on) {
  const bool were_noted = are_readings_noted;
  are_readings_noted = is_on || link.tells_readings();
  if (!were_noted) begin_readings();
}

bool port_has_reading() { return count != 0 || dropped_sensors.first() != kAllSensors; }

ReadingReport port_next_reading() {
  if (count == 0) {
    const uint8_t sensor = dropped_sensors.first();
    dropped_sensors.remove(sensor);
    return reading_of(sensor | kAfterGap, board_readings()[sensor]);
  }
  const ReadingReport& reading = reports[oldest];
  oldest = static_cast<uint8_t>((oldest + 1) % kMaxReadings);
  count--;
  return reading;
}

}  // namespace tiniscript

#endif
