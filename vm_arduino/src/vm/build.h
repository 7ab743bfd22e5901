// What this build has, in one place for C++ and assembly. All that is conditional in `vm/` is here, in
// `cpu.h`, or encloses a whole file.
//
// The machine of an AVR is in assembly. With `tiniscript_portable` it is the C++ of all other chips,
// which tests compare with that.
//
// Tasks take about 1,200 bytes of flash and 88 of RAM. An Uno has them with the compiler's options
// of platformio.ini (`tiniscript_with_tasks`). With those of the Arduino IDE it has none, nor has a
// Nano, whose bootloader leaves 30,720 bytes.
//
// An ATmega328P has discs, which measure a way, in the place of the reader of text
// (`tiniscript_with_discs`).

#pragma once

#if defined(__AVR__) && !defined(tiniscript_portable)
#define tiniscript_in_assembly
#endif

#if !defined(__AVR_ATmega328P__) || defined(tiniscript_with_tasks)
#define tiniscript_has_tasks
#elif defined(tiniscript_with_discs)
#error "a robot with discs has tasks"
#endif

#if !defined(__AVR_ATmega328P__) || defined(tiniscript_with_discs) || \
    defined(tiniscript_portable)
#define tiniscript_has_discs
#endif

#if defined(__AVR_ATmega328P__) && defined(tiniscript_with_discs)
#define tiniscript_without_text
#endif

// How it moves: one of three files.
#ifndef tiniscript_has_tasks
#define tiniscript_drives_alone  // drive_alone.cpp
#elif defined(tiniscript_in_assembly) && !defined(tiniscript_has_discs)
#define tiniscript_drives_in_assembly  // tasks_avr.S
#else
#define tiniscript_drives_in_turns  // drive.cpp
#endif

#ifndef __ASSEMBLER__

#include <stdint.h>

namespace tiniscript {

#ifdef tiniscript_in_assembly
constexpr bool kInAssembly = true;
#else
constexpr bool kInAssembly = false;
#endif

#ifdef tiniscript_has_tasks
constexpr bool kHasTasks = true;
#define tini_of_tasks(...) __VA_ARGS__
#else
constexpr bool kHasTasks = false;
#define tini_of_tasks(...)
#endif

#ifdef tiniscript_has_discs
constexpr bool kHasDiscs = true;
#else
constexpr bool kHasDiscs = false;
#endif

// Whether a budget counts all instructions, not only jumps back and calls.
#ifdef tiniscript_counts_instructions
constexpr bool kCountsInstructions = true;
#else
constexpr bool kCountsInstructions = false;
#endif

// The budget of a tick in a main loop. An AVR leaves it where an interrupt has an event.
#ifdef __AVR__
constexpr uint8_t kTickBudget = 255;
#else
constexpr uint8_t kTickBudget = 32;
#endif

}  // namespace tiniscript

#endif
