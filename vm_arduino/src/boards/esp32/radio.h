// The radios of an ESP32: a task and a pipe for each transport, in addition to the main loop.
//
// The tasks are on core 0, where the core has its radio stacks; the main loop is on core 1, and
// takes bytes from pipes. So a radio that waits delays neither motors nor the other radios. An
// ESP32-C3 has one core: there the tasks take turns with the main loop.

#pragma once

#include <stdint.h>

#include "../../firmware/firmware.h"
#include "../../link/transports.h"
#include "pipe.h"

namespace tiniscript {

// Silence after which a client's place goes to another one that comes; never before.
constexpr uint32_t kPlaceMs = 10000;

// Called by the main loop: these begin the radios when the robot knows its name, take what they
// have received, and give them what is to be sent.
void radio_tick();
void radio_poll();
void radio_send();

// Bytes that found no room. It wraps around to 0.
uint8_t radio_lost();

// Each task consists of an initialization, called once in the task, and `turn`, called every
// millisecond.
const RadioName& radio_name();
Pipe& radio_pipe(Transport transport);

bool spp_begin();  // whether this chip has Bluetooth with a serial port
void spp_turn();
void low_energy_begin();
void low_energy_turn();
void network_begin();
void network_turn();
void broker_turn();

}  // namespace tiniscript
