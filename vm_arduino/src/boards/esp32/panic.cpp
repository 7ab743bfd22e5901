// A panic of the chip: an exception, an abort or a watchdog. Before anything of it is printed the
// motors are off.
//
// Version 3 of the core lets a sketch come first; for version 2 `platformio.ini` has the linker put
// this function before that of ESP-IDF. Both are there weakly: the Arduino IDE gives no such option.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>
#include <esp_attr.h>

#include "watchdog.h"

extern "C" void tiniscript_motors_low();

#if ESP_ARDUINO_VERSION_MAJOR >= 3

namespace tiniscript {

namespace {

void IRAM_ATTR on_panic(arduino_panic_info_t*, void*) { tiniscript_motors_low(); }

}  // namespace

void panic_begin() { set_arduino_panic_handler(on_panic, nullptr); }

}  // namespace tiniscript

#else

extern "C" void __attribute__((weak)) __real_esp_panic_handler(void* info);

extern "C" void IRAM_ATTR __attribute__((weak, used)) __wrap_esp_panic_handler(void* info) {
  tiniscript_motors_low();
  if (__real_esp_panic_handler != nullptr) __real_esp_panic_handler(info);
}

namespace tiniscript {

void panic_begin() {}

}  // namespace tiniscript

#endif

#endif  // ARDUINO_ARCH_ESP32
