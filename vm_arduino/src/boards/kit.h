// Selects the robot: kits/own.h if that file exists, otherwise the TiniBot of the chip. `pio run -e
// nano_liner` selects another one; in the Arduino IDE, write a line here such as #define
// tiniscript_liner

#pragma once

#include "../store/layout.h"
#include "../vm/cpu.h"
#include "analog.h"
#include "chip.h"
#include "discs.h"
#include "motors.h"
#include "servo.h"
#include "ultrasonic.h"

#if defined(tiniscript_own)  // a header elsewhere, for tests
#include tiniscript_own
#elif defined(tiniscript_liner)
#include "kits/liner.h"
#elif defined(tiniscript_grabber)
#include "kits/grabber.h"
#elif defined(tiniscript_elegoo4)
#include "kits/elegoo4.h"
#elif defined(tiniscript_sumo)
#include "kits/sumo.h"
#elif defined(tiniscript_tinibot2)
#include "kits/tinibot2.h"
#elif __has_include("kits/own.h") && !defined(tiniscript_tinibot)
#include "kits/own.h"
#elif defined(tiniscript_with_discs)
#include "kits/tinibot2.h"
#elif defined(CONFIG_IDF_TARGET_ESP32)
#include "kits/tinibot32.h"
#elif defined(CONFIG_IDF_TARGET_ESP32C3)
#include "kits/tinibotc3.h"
#else
#include "kits/tinibot.h"
#endif

static_assert(tiniscript::kProgramBytes <= tiniscript::kStoredCodeBytes, "the store has less room");
