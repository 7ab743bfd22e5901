// The headers of the chip's family: its clock, pins and watchdog, and the events of its main loop.
//
// Each family has its own folder, with the same names in it.

#pragma once

#ifdef __AVR__
#include "avr/clock.h"
#include "avr/echo.h"
#include "avr/echo_interrupt.h"
#include "avr/events.h"
#include "avr/pins.h"
#include "avr/watchdog.h"
#elif defined(ARDUINO_ARCH_ESP32)
#include "esp32/clock.h"
#include "esp32/echo.h"
#include "esp32/events.h"
#include "esp32/pins.h"
#include "esp32/watchdog.h"
#else
#error "There is no firmware for this chip."
#endif
