// The receiver of a robot that is reached over one line: for the interrupt of an AVR, and for tests.

#pragma once

#include "../link/receiver.h"

namespace tiniscript {

extern Receiver receiver;

}  // namespace tiniscript
