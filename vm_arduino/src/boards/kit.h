// Chooses the robot that the sketch is for: a robot of your own where kits/own.h is there, else
// tinibot. `pio run -e nano_liner` says it; for the Arduino IDE write a line here, such as
// #define tiniscript_liner

#ifndef TINISCRIPT_BOARDS_KIT_H_
#define TINISCRIPT_BOARDS_KIT_H_

#include "analog.h"
#include "echo.h"
#include "motors.h"
#include "pins.h"
#include "servo.h"

#if defined(tiniscript_liner)
#include "kits/liner.h"
#elif defined(tiniscript_grabber)
#include "kits/grabber.h"
#elif __has_include("kits/own.h") && !defined(tiniscript_tinibot)
#include "kits/own.h"
#else
#include "kits/tinibot.h"
#endif

#endif  // TINISCRIPT_BOARDS_KIT_H_
