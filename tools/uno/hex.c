// Intel HEX files: what they put where in the chip's flash.
//
// libsimavr 1.6 refuses the record that says where a program begins, which Optiboot's file has.

#include <stdio.h>
#include <string.h>

#include "uno.h"

enum {
  kLine = 600,
  kMaxBytes = 255,
  kData = 0,
  kEnd = 1,
  kSegment = 2,
  kLinear = 4,  // 3 and 5 say where it begins: the chip knows better
  kLastType = 5,
};

struct Record {
  uint8_t count;
  uint16_t address;
  uint8_t type;
  uint8_t bytes[kMaxBytes];
};

static bool read_record(const char* line, struct Record* record) {
  uint8_t raw[kMaxBytes + 5];
  size_t length = 0;
  uint8_t sum = 0;
  if (*line++ != ':') return false;
  for (unsigned byte; length < sizeof raw && sscanf(line, "%2x", &byte) == 1; line += 2) {
    raw[length++] = (uint8_t)byte;
    sum = (uint8_t)(sum + byte);
    if (!line[1]) return false;
  }
  if (length < 5 || length != raw[0] + 5u || sum != 0) return false;
  *record = (struct Record){raw[0], (uint16_t)(raw[1] << 8 | raw[2]), raw[3], {0}};
  memcpy(record->bytes, raw + 4, record->count);
  return record->type <= kLastType;
}

bool hex_load(const char* name, uint8_t* flash, uint32_t room, uint32_t* begin) {
  FILE* file = fopen(name, "r");
  if (!file) return false;
  char line[kLine];
  uint32_t base = 0;
  bool is_good = true, has_ended = false;
  *begin = room;
  while (is_good && !has_ended && fgets(line, sizeof line, file)) {
    struct Record record;
    is_good = read_record(line, &record);
    if (!is_good) break;
    const uint32_t value = (uint32_t)(record.bytes[0] << 8 | record.bytes[1]);
    if (record.type == kSegment) base = value << 4;
    if (record.type == kLinear) base = value << 16;
    has_ended = record.type == kEnd;
    if (record.type != kData) continue;
    const uint32_t from = base + record.address;
    is_good = from <= room && record.count <= room - from;
    if (!is_good) break;
    memcpy(flash + from, record.bytes, record.count);
    if (from < *begin) *begin = from;
  }
  fclose(file);
  return is_good && has_ended && *begin < room;
}
