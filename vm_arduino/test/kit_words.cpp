// The words of the robot for which the tests of the reader compile.

#include "../src/text/kit_words.h"

using namespace tiniscript;

namespace {

// DISTANCE, a number; TOUCH, a yes/no; the actuator ARM from 0 to 180.
const uint8_t words[] = {'D',
                         'I',
                         'S',
                         'T',
                         'A',
                         'N',
                         'C',
                         'E' | 0x80,
                         0,
                         'T',
                         'O',
                         'U',
                         'C',
                         'H' | 0x80,
                         kDeviceIsYesNo,
                         'A',
                         'R',
                         'M' | 0x80,
                         kDeviceIsActuator,
                         0,
                         0,
                         0,
                         0,
                         0x20,
                         0xbf,
                         0x02,
                         0,
                         0};

}  // namespace

const uint8_t* tiniscript::robot_words() { return words; }

uint16_t tiniscript::robot_language() { return 0; }
