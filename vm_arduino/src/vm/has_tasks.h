// Which machines are in assembly, and which have TASK and WHEN, in one place for C++ and assembly; and
// which firmware can measure a way with discs, and reads text.
//
// The machine of an AVR is in assembly. With `tiniscript_portable` it is the C++ of all other chips,
// which tests compare with that.
//
// Tasks take about 1,200 bytes of flash and 88 of RAM. An Uno has them with the compiler's options
// of platformio.ini (`tiniscript_with_tasks`). With those of the Arduino IDE it has none, nor has a
// Nano, whose bootloader leaves 30,720 bytes.
//
// An ATmega328P has discs in the place of the reader of text (`tiniscript_with_discs`).

#pragma once

#if defined(__AVR__) && !defined(tiniscript_portable)
#define tiniscript_in_assembly
#endif

#if !defined(__AVR_ATmega328P__) || defined(tiniscript_with_tasks)
#define tiniscript_has_tasks
#endif

#ifndef __AVR_ATmega328P__
#define tiniscript_has_discs
#elif defined(tiniscript_with_discs)
#define tiniscript_has_discs
#define tiniscript_without_text
#endif
