// A connection to an MQTT broker, over which one client at a time reaches the robot.

#ifndef TINISCRIPT_ESP32_BROKER_H_
#define TINISCRIPT_ESP32_BROKER_H_

namespace tiniscript {

// The network's task, every millisecond: connects, passes bytes on, and connects again.
void broker_turn(bool has_network);

}  // namespace tiniscript

#endif  // TINISCRIPT_ESP32_BROKER_H_
