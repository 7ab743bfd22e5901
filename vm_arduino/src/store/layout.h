// The layout of everything that a robot saves in its EEPROM.
//
// The only definition of these numbers; `docs/develop/store.md` draws them. Does not know how they are
// written.

#pragma once

#include <stdint.h>

#include "../vm/bytecode.h"

namespace tiniscript {

// The EEPROM size: Mega 2560; what an ESP32 has in its place, with room for 8,192 bytes of code;
// Uno and Nano.
constexpr uint16_t kMemoryBytes =
    kRobotSize == RobotSize::kMega ? 4096 : kRobotSize == RobotSize::kEsp32 ? 16640 : 1024;

// Each kind of data has an area of A/B slots: one holds the current data, the other one is written.
// Slots are numbered: those of programs are 0 and 1.
enum class Area : uint8_t { kProgram, kIdentity, kFault, kOwner };
constexpr uint8_t kAreas = 4;
constexpr uint8_t kSlots = 2 * kAreas;

// A slot: the generation of its data, three marks, and the data itself, its body.
constexpr uint8_t kMarks = 3;
constexpr uint8_t kBodyAt = 1 + kMarks;

// The body of a program is its image, with the check in the header. Other bodies are records: they
// begin with their check, the CRC-32 of everything after it.
constexpr uint8_t kCheckBytes = 4;
constexpr uint8_t kRecordBytes = 27;

// The record kIdentity: the robot's identity.
constexpr uint8_t kIdAt = kCheckBytes;
constexpr uint8_t kIdBytes = 4;
constexpr uint8_t kNameAt = kIdAt + kIdBytes;
constexpr uint8_t kNameRoom = 16;
constexpr uint8_t kTrimAt = kNameAt + kNameRoom;  // of the motors
constexpr uint8_t kTrimBytes = 3;
static_assert(kTrimAt + kTrimBytes == kRecordBytes, "who the robot is fills a record");

// The record kFault: the last fault, and how fast the robot was measured to be.
constexpr uint8_t kFaultAt = kCheckBytes;
constexpr uint8_t kFaultRoom = 15;
constexpr uint8_t kPaceAt = kFaultAt + kFaultRoom;
constexpr uint8_t kPaceBytes = 8;  // zeros: not measured, as earlier firmware wrote
static_assert(kPaceAt + kPaceBytes == kRecordBytes, "fault and pace fill a record");

// The record kOwner is larger: the keys of the robot, zeros where there is none.
constexpr uint8_t kOwnerKeys = 2;
constexpr uint8_t kKeyRoom = 16;
constexpr uint8_t kKeysAt = kCheckBytes;
constexpr uint8_t kOwnerBytes = kKeysAt + kOwnerKeys * kKeyRoom;

// The offsets at which the slots begin. During a brown-out some chips write to address 0 by
// mistake, so nothing is stored there.
constexpr uint16_t kRecordsAt = 4;
constexpr uint16_t kRecordSlot = kBodyAt + kRecordBytes;
constexpr uint8_t kSmallRecords = 4;  // slots of kRecordSlot
constexpr uint8_t kFirstOwnerSlot = 2 + kSmallRecords;
constexpr uint16_t kProgramsAt = kRecordsAt + kSmallRecords * kRecordSlot;
constexpr uint16_t kProgramDistance = (kMemoryBytes - kProgramsAt) / 2;

// After each of the two programs is a slot of the record kOwner.
constexpr uint8_t kOwnerSlot = kBodyAt + kOwnerBytes;
constexpr uint16_t kProgramSlot = kProgramDistance - kOwnerSlot;

// The largest image and the largest program that can be saved.
constexpr uint16_t kImageBytes = kProgramSlot - kBodyAt;
constexpr uint16_t kStoredCodeBytes = kImageBytes - kHeaderBytes;

constexpr uint16_t place_of(uint8_t slot) {
  return static_cast<uint16_t>(slot < 2 ? kProgramsAt + slot * kProgramDistance
                               : slot < kFirstOwnerSlot
                                   ? kRecordsAt + (slot - 2) * kRecordSlot
                                   : kProgramsAt + kProgramSlot +
                                         (slot - kFirstOwnerSlot) * kProgramDistance);
}

static_assert(kProgramsAt >= kRecordsAt + 4 * kRecordSlot, "no slot lies in another one");
static_assert(place_of(kSlots - 1) + kOwnerSlot <= kMemoryBytes, "the slots fit in");
static_assert(kStoredCodeBytes >= 384, "the code of a program has room");
static_assert(kStoredCodeBytes <= kCodeBytes, "its length has room in the header");
static_assert(kHeaderBytes > kChecksumAt + kCheckBytes, "the check lies in the header");

}  // namespace tiniscript
