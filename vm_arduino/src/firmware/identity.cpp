#include "identity.h"

#include "../link/frames.h"
#include "../link/text_level.h"
#include "../robot.h"
#include "../store/layout.h"
#include "../vm/small.h"
#include "firmware.h"
#include "persistence.h"
#include "state.h"
#include "trim.h"

namespace tiniscript {

namespace {

Identity identity;
DeviceInfo device_info;
Tuning tuning;

static_assert(sizeof(Trim) == kTrimBytes && sizeof(Pace) == kPaceBytes,
              "they are kept as they are sent");

bool update_bytes(uint8_t* to, const uint8_t* from, uint8_t length) {
  bool is_changed = false;
  for (uint8_t k = 0; k < length; k++) {
    if (to[k] != from[k]) is_changed = true;
    to[k] = from[k];
  }
  return is_changed;
}

}  // namespace

void begin_identity(const BootInfo& boot_info) {
  identity.kit = board_kit();
  identity.nonce = boot_info.seed;
  identity.reset = boot_info.reset;
  const bool has_remote = readings_of(board_sensors()) != board_sensors();
  identity.features = static_cast<uint8_t>(kRobotTextLevel) | (has_remote ? kRemote : 0) | kPlaces;
  if (kHasBreakpoints) identity.more_features = kMoreBreakpoints | kMoreReadings;
}

void make_identity() { identity.id = identity.nonce; }

void read_identity(const uint8_t* record) {
  identity.id = get32(record + kIdAt);
  uint8_t length = 0;
  while (length < kNameBytes && record[kNameAt + length] != 0) length++;
  change_name(record + kNameAt, length);
  const Trim& trim = *reinterpret_cast<const Trim*>(record + kTrimAt);
  if (is_sound(trim)) tuning.trim = trim;  // otherwise it was written by other firmware
}

void write_identity(uint8_t* record) {
  copy_bytes(&identity.id, record + kIdAt, sizeof identity.id);
  copy_bytes(device_info.name, record + kNameAt, device_info.name_length);
  copy_bytes(&tuning.trim, record + kTrimAt, sizeof(Trim));
}

void read_pace(const uint8_t* record) {
  copy_bytes(record + kPaceAt, reinterpret_cast<uint8_t*>(&tuning.pace), sizeof(Pace));
}

bool change_name(const uint8_t* name, uint8_t length) {
  const bool is_other_length = update_bytes(&device_info.name_length, &length, 1);
  return update_bytes(device_info.name, name, length) || is_other_length;
}

bool change_tuning(const Tuning& new_tuning, bool has_pace) {
  return update_bytes(reinterpret_cast<uint8_t*>(&tuning),
                      reinterpret_cast<const uint8_t*>(&new_tuning),
                      has_pace ? sizeof(Tuning) : sizeof(Trim));
}

Identity& port_identity() { return identity; }

const DeviceInfo& port_device_info() { return device_info; }

uint8_t port_readings() { return readings_of(board_sensors()); }

uint8_t port_actuators() { return board_actuators(); }

const Tuning& port_tuning() { return tuning; }

}  // namespace tiniscript
