// Images and records to keep, and chance.

#pragma once

#include <stdint.h>

#include <vector>

#include "../../src/store/store.h"

namespace tiniscript {

// Any number less than `end`, the same ones in each run.
uint32_t random_below(uint32_t end);
void seed_random(uint32_t seed);

using Content = std::vector<uint8_t>;  // empty: nothing

// Puts the checksum of an image into it.
Content with_checksum(Content image);

// An image with so many bytes of code, any ones.
Content random_image(uint16_t code_bytes);

// A record of anything, with its check.
Content random_record(Area area);

// Begins to save content, which must not change until that is done. False: the store refuses it.
bool begin(Store* store, Area area, Content* content);

// What counts in an area, all of it. Where it cannot be read the program ends.
Content read(const Store& store, Area area);

}  // namespace tiniscript
