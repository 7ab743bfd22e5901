// Selects the robot: kits/own.h if that file exists, else tinibot. `pio run -e nano_liner` selects
// another one; in the Arduino IDE, write a line here such as #define tiniscript_liner

#ifndef TINISCRIPT_BOARDS_KIT_H_
#define TINISCRIPT_BOARDS_KIT_H_

#include "../vm/flash.h"
#include "analog.h"
#include "motors.h"
#include "chip.h"
#include "servo.h"
#include "ultrasonic.h"

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
