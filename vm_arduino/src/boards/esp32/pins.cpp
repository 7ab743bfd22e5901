#ifdef ARDUINO_ARCH_ESP32

#include "pins.h"

namespace tiniscript {

portMUX_TYPE critical_mux = portMUX_INITIALIZER_UNLOCKED;

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
