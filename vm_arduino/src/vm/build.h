// The features of this build, in one place for C++ and assembly. All that is conditional in `vm/`
// is here, in `cpu.h`, in `layout_avr.h`, or encloses a whole file, or chooses a file; and so in
// the other folders, but for `boards/`. In one file of assembly a part is conditional:
// `bytecode_avr.S` says what a machine without tasks does about theirs.
//
// The machine of an AVR is in assembly. With `tiniscript_portable`, it has the C++ of all other
// chips, which tests compare with the assembly.
//
// Tasks take about 1,200 bytes of flash and 88 of RAM. An Uno has them with the compiler's options
// of platformio.ini (`tiniscript_with_tasks`). With those of the Arduino IDE it has none, and
// neither has a Nano, whose bootloader leaves 30,720 bytes.
//
// An ATmega328P has discs, which measure a way (`tiniscript_with_discs`), or breakpoints
// (`tiniscript_with_breakpoints`) in the place of the reader of text.

#pragma once

#if defined(__AVR__) && !defined(tiniscript_portable)
#define tiniscript_in_assembly
#endif

#if !defined(__AVR_ATmega328P__) || defined(tiniscript_with_tasks)
#define tiniscript_has_tasks
#elif defined(tiniscript_with_discs)
#error "a robot with discs has tasks"
#elif defined(tiniscript_with_breakpoints)
#error "a robot with breakpoints has tasks"
#endif

#if !defined(__AVR_ATmega328P__) || defined(tiniscript_with_discs) || \
    defined(tiniscript_portable)
#define tiniscript_has_discs
#endif

#if defined(__AVR_ATmega328P__) && \
    (defined(tiniscript_with_discs) || defined(tiniscript_with_breakpoints))
#define tiniscript_without_text
#endif

// An ATmega328P's reader of text has no DEFs, and with them no tasks and ways; tiniscript_no_defs is for
// tests of that.
#if !defined(__AVR_ATmega328P__) && !defined(tiniscript_no_defs)
#define tiniscript_reads_defs
#endif

// A remote control takes about 250 bytes of flash and 37 of RAM. An ATmega328P has it with the compiler's
// options of platformio.ini (`tiniscript_with_remote`), but for a robot with discs, which lacks the RAM.
#if !defined(__AVR_ATmega328P__) || \
    (defined(tiniscript_with_remote) && !defined(tiniscript_with_discs))
#define tiniscript_has_remote
#endif

// Lines of text that are its words, KEY_A and the like: an ATmega328P has no room for them.
#if defined(tiniscript_has_remote) && defined(tiniscript_reads_defs)
#define tiniscript_reads_keys
#endif

// Places where a program halts, so that a computer follows it step by step: an ATmega328P has room for
// them only without the reader of text (`tiniscript_with_breakpoints`); tiniscript_without_breakpoints is
// for tests.
#if (!defined(__AVR_ATmega328P__) || defined(tiniscript_with_breakpoints)) && \
    !defined(tiniscript_without_breakpoints)
#define tiniscript_has_breakpoints
#endif

// Readings of a program, reported to a computer that wants them: an ATmega328P lacks the RAM.
#if defined(tiniscript_has_breakpoints) && !defined(__AVR_ATmega328P__)
#define tiniscript_tells_readings
#endif

// An ATmega328P reads a program where the one is that it holds; tiniscript_no_draft is for tests of
// that. Others have room for both.
#if (!defined(__AVR__) || defined(__AVR_ATmega2560__)) && !defined(tiniscript_no_draft)
#define tiniscript_has_draft
#endif

// Seals of frames: a Mega can, where it is built with tiniscript_with_seals; an Uno and a Nano have no
// room. All other chips do, unless tiniscript_without_seals.
#if (defined(tiniscript_with_seals) || !defined(__AVR__)) && !defined(tiniscript_without_seals)
#define tiniscript_seals
#endif

// An ESP32 is reached over several transports at once: each has a link of its own then, and one of them
// drives (`link/links.h`). All others have one.
#ifdef ARDUINO_ARCH_ESP32
#define tiniscript_transports
#endif

// Members that only a machine with tasks has.
#ifdef tiniscript_has_tasks
#define tini_of_tasks(...) __VA_ARGS__
#else
#define tini_of_tasks(...)
#endif

// Its turns and moves: one of three.
#ifndef tiniscript_has_tasks
#define tiniscript_drives_alone  // drive_alone.cpp
#elif defined(tiniscript_in_assembly) && !defined(tiniscript_has_discs)
#define tiniscript_tasks_in_assembly  // tasks_avr.S: an Uno
#else
#define tiniscript_drives_in_turns  // turns.cpp, drive.cpp
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
#else
constexpr bool kHasTasks = false;
#endif

#ifdef tiniscript_has_discs
constexpr bool kHasDiscs = true;
#else
constexpr bool kHasDiscs = false;
#endif

#ifdef __AVR__
constexpr bool kIsAvr = true;
#else
constexpr bool kIsAvr = false;
#endif

// One of two types.
template <bool kIsFirst, class First, class>
struct Choice {
  typedef First Type;
};

template <class First, class Second>
struct Choice<false, First, Second> {
  typedef Second Type;
};

// A member of a class that only some robots have: `tini_with_remote` is before it. On a robot
// without the feature, it is a static member that nothing defines, and takes no memory. Its uses
// come after the constant, `kHasRemote`, and are left out there.

#ifdef tiniscript_without_text
constexpr bool kHasText = false;
#define tini_with_text static
#else
constexpr bool kHasText = true;
#define tini_with_text
#endif

#ifdef tiniscript_reads_defs
constexpr bool kReadsDefs = true;
#define tini_with_defs
#define tini_of_defs(...) __VA_ARGS__
#else
constexpr bool kReadsDefs = false;
#define tini_with_defs static
#define tini_of_defs(...)
#endif

#ifdef tiniscript_has_remote
constexpr bool kHasRemote = true;
#define tini_with_remote
#else
constexpr bool kHasRemote = false;
#define tini_with_remote static
#endif

#ifdef tiniscript_reads_keys
constexpr bool kReadsKeys = true;
#define tini_with_keys
#else
constexpr bool kReadsKeys = false;
#define tini_with_keys static
#endif

#ifdef tiniscript_has_breakpoints
constexpr bool kHasBreakpoints = true;
#define tini_with_breakpoints
#define tini_of_breakpoints(...) __VA_ARGS__
#else
constexpr bool kHasBreakpoints = false;
#define tini_with_breakpoints static
#define tini_of_breakpoints(...)
#endif

#ifdef tiniscript_tells_readings
constexpr bool kTellsReadings = true;
#define tini_with_readings
#define tini_of_readings(...) __VA_ARGS__
#else
constexpr bool kTellsReadings = false;
#define tini_with_readings static
#define tini_of_readings(...)
#endif

#ifdef tiniscript_has_draft
constexpr bool kTextIsInProgram = false;
#else
constexpr bool kTextIsInProgram = true;
#endif

#ifdef tiniscript_transports
constexpr bool kHasTransports = true;
#define tini_with_transports
#else
constexpr bool kHasTransports = false;
#define tini_with_transports static
#endif

// Whether this robot knows owners. The code that the Arduino IDE's own options make for an Uno or a Nano
// is too long for that; platformio.ini has shorter ones, and says tiniscript_with_owners.
#if defined(tiniscript_without_owners) || \
    (defined(__AVR_ATmega328P__) && !defined(tiniscript_with_owners))
constexpr bool kHasOwners = false;
#else
constexpr bool kHasOwners = true;
#endif

#ifdef tiniscript_seals
constexpr bool kMaySeal = true;
#define tini_with_seals
#else
constexpr bool kMaySeal = false;
#define tini_with_seals static
#endif

constexpr bool kHasSeals = kMaySeal && kHasOwners;

// The board whose size it has; tiniscript_like_mega and tiniscript_like_esp32 are for robots on a
// computer.
enum class RobotSize : uint8_t { kUno, kMega, kEsp32 };

#if defined(__AVR_ATmega2560__) || defined(tiniscript_like_mega)
constexpr RobotSize kRobotSize = RobotSize::kMega;
#elif defined(ARDUINO_ARCH_ESP32) || defined(tiniscript_like_esp32)
constexpr RobotSize kRobotSize = RobotSize::kEsp32;
#else
constexpr RobotSize kRobotSize = RobotSize::kUno;
#endif

// Whether writing its memory stops the chip for long, so that writes must wait while motors are on;
// such a memory may also refuse the last bytes of a save, because it is full.
#ifdef ARDUINO_ARCH_ESP32
constexpr bool kWritesStopTheChip = true;
#else
constexpr bool kWritesStopTheChip = false;
#endif

// A bit for each sensor. A board with an ATmega328P has pins for at most 16.
#ifdef __AVR_ATmega328P__
typedef uint16_t SensorBits;
#else
typedef uint32_t SensorBits;
#endif

// Whether a budget counts all instructions, not only jumps back and calls.
#ifdef tiniscript_counts_instructions
constexpr bool kCountsInstructions = true;
#else
constexpr bool kCountsInstructions = false;
#endif

// The budget of a tick in a main loop. An AVR leaves it where an interrupt has an event.
constexpr uint8_t kTickBudget = kIsAvr ? 255 : 32;

// Operations that the CPU does at once, if the arithmetic is in C++.
#if defined(__x86_64__) || defined(__aarch64__) || defined(__wasm__)
constexpr bool kHasQuotient64 = true;
#else
constexpr bool kHasQuotient64 = false;
#endif

#ifdef __riscv_mul
constexpr bool kHasProduct64 = true;
#else
constexpr bool kHasProduct64 = false;
#endif

#ifdef __XTENSA_CALL0_ABI__
constexpr bool kHasQuotient32 = false;  // an ESP8266
#else
constexpr bool kHasQuotient32 = true;
#endif

}  // namespace tiniscript

#endif
