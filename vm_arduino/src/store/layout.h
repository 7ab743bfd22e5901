// Where everything lies that a robot keeps without power.
//
// The one home of these numbers; `docs/store.md` draws them. Knows nothing of how they are written.

#ifndef TINISCRIPT_STORE_LAYOUT_H_
#define TINISCRIPT_STORE_LAYOUT_H_

#include <stdint.h>

#include "../vm/bytecode.h"

namespace tiniscript {

// The EEPROM of the chip: Mega 2560; Uno and Nano.
#ifdef __AVR_ATmega2560__
constexpr uint16_t kMemoryBytes = 4096;
#else
constexpr uint16_t kMemoryBytes = 1024;
#endif

// What is kept: each in an area of A/B slots: one holds what counts, the other one is written. A
// slot has a number: those of a program are 0 and 1.
enum class Area : uint8_t { kProgram, kIdentity, kFault };
constexpr uint8_t kAreas = 3;
constexpr uint8_t kSlots = 2 * kAreas;

// A slot: the generation of what it holds, three marks, and that itself, its body.
constexpr uint8_t kMarks = 3;
constexpr uint8_t kBodyAt = 1 + kMarks;

// The body of a program is its image, whose check is in its header. That of the others is a record:
// it begins with its check, the CRC-32 of all that follows.
constexpr uint8_t kCheckBytes = 4;
constexpr uint8_t kRecordBytes = 27;

// The record kIdentity: who the robot is.
constexpr uint8_t kIdAt = kCheckBytes;
constexpr uint8_t kIdBytes = 4;
constexpr uint8_t kNameAt = kIdAt + kIdBytes;
constexpr uint8_t kNameRoom = 16;
constexpr uint8_t kTrimAt = kNameAt + kNameRoom;  // of the motors
constexpr uint8_t kTrimBytes = 3;
static_assert(kTrimAt + kTrimBytes == kRecordBytes, "who the robot is fills a record");

// The record kFault: the last fault. The rest of it is free.
constexpr uint8_t kFaultAt = kCheckBytes;
constexpr uint8_t kFaultRoom = 16;
static_assert(kFaultAt + kFaultRoom <= kRecordBytes, "a fault fits into a record");

// Where the slots begin. When the voltage falls, some chips write to place 0 by mistake: nothing is
// ever there.
constexpr uint16_t kRecordsBegin = 4;
constexpr uint16_t kRecordSlot = kBodyAt + kRecordBytes;
constexpr uint16_t kProgramsBegin = kRecordsBegin + (kSlots - 2) * kRecordSlot;
constexpr uint16_t kProgramSlot = (kMemoryBytes - kProgramsBegin) / 2;

// The largest image and the largest program that are kept.
constexpr uint16_t kImageBytes = kProgramSlot - kBodyAt;
constexpr uint16_t kStoredCodeBytes = kImageBytes - kHeaderBytes;

constexpr uint16_t place_of(uint8_t slot) {
  return static_cast<uint16_t>(slot == 0   ? kProgramsBegin
                               : slot == 1 ? kProgramsBegin + kProgramSlot
                                           : kRecordsBegin + (slot - 2) * kRecordSlot);
}

static_assert(kProgramsBegin >= kRecordsBegin + 4 * kRecordSlot, "no slot lies in another one");
static_assert(place_of(1) + kProgramSlot <= kMemoryBytes, "the slots fit into the memory");
static_assert(kStoredCodeBytes >= 430, "the code of a program has room");
static_assert(kStoredCodeBytes <= kCodeBytes, "its length has room in the header");
static_assert(kHeaderBytes == kChecksumAt + kCheckBytes, "the check ends the header");

}  // namespace tiniscript

#endif  // TINISCRIPT_STORE_LAYOUT_H_
