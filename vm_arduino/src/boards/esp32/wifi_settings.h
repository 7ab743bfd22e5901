// The robot's WiFi: which network it joins or is, kept in NVS, and whether it is there.
//
// The main loop sets it; the task of the network acts on it.

#pragma once

#include <stdint.h>

namespace tiniscript {

// The main loop's, once: reads the data of NVS.
void wifi_load();

// The network's task: joins the network or opens it, again after a change. Returns whether the
// robot has an address.
bool wifi_turn();

// Any task: whether it had one in the last turn.
bool wifi_is_there();

}  // namespace tiniscript
