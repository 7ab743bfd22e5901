#include "identity.h"

#include "../link/frames.h"
#include "../store/layout.h"
#include "state.h"
#include "trim.h"

namespace tiniscript {

namespace {

Card card;
Equipment equipment;
Trim trim;

static_assert(sizeof trim == kTrimBytes, "it is kept as it is sent");

bool change(uint8_t* to, const uint8_t* from, uint8_t length) {
  bool is_changed = false;
  for (uint8_t k = 0; k < length; k++) {
    if (to[k] != from[k]) is_changed = true;
    to[k] = from[k];
  }
  return is_changed;
}

}  // namespace

void begin_identity() {
  card.kit = board.kit;
  card.nonce = board.seed;
  card.reset = board.reset;
  equipment.sensors = board.sensors;
  equipment.actuators = board.actuators;
}

void make_identity() { card.id = board.seed; }

void read_identity(const uint8_t* record) {
  card.id = get32(record + kIdAt);
  while (equipment.name_length < kNameBytes && record[kNameAt + equipment.name_length] != 0) {
    equipment.name[equipment.name_length] = record[kNameAt + equipment.name_length];
    equipment.name_length++;
  }
  copy_bytes(record + kTrimAt, reinterpret_cast<uint8_t*>(&trim), sizeof trim);
  if (!is_sound(trim)) trim = Trim();  // of other firmware
}

void write_identity(uint8_t* record) {
  copy_bytes(&card.id, record + kIdAt, sizeof card.id);
  copy_bytes(equipment.name, record + kNameAt, equipment.name_length);
  copy_bytes(&trim, record + kTrimAt, sizeof trim);
}

bool change_name(const uint8_t* name, uint8_t length) {
  const bool is_other_length = change(&equipment.name_length, &length, 1);
  return change(equipment.name, name, length) || is_other_length;
}

bool change_trim(const Trim& found) {
  return change(reinterpret_cast<uint8_t*>(&trim), reinterpret_cast<const uint8_t*>(&found),
                sizeof trim);
}

const Card& port_card() { return card; }

const Equipment& port_equipment() { return equipment; }

const Trim& port_trim() { return trim; }

}  // namespace tiniscript
