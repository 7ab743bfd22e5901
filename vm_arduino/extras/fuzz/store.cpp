// The store at start and in saves, on an EEPROM of anything whose plug is pulled at any write.
//
// An input is a seed, bytes for the EEPROM in pieces (or nothing: it is new), and a row of what is
// done. After each start everything that counts can be read, the checksum of a program that counts
// is right, and the next starts find the same.

#include <string.h>

#include "../../src/vm/image.h"
#include "../powercut/contents.h"
#include "../powercut/memory.h"
#include "input.h"

using namespace tiniscript;

namespace {

constexpr uint8_t kMaxActions = 12;
constexpr uint32_t kMaxTicks = 20000;

bool has_cut;  // in this input

void run(Store* store) {
  for (uint32_t ticks = 0; store->is_busy() && !memory.is_off; ticks++) {
    must(ticks < kMaxTicks);
    memory.is_writing = false;
    store->tick(true);
  }
  memory.is_writing = false;
}

void start(Store* store) {
  memory.is_off = false;
  memory.is_cut_next = false;
  store->boot();
  run(store);
  must(store->state() == StoreState::kIdle && !store->is_busy());
}

// A slot may count that holds no image at all: the store knows checksums alone.
Content valid_content(const Store& store, Area area) {
  const Content content = read(store, area);
  if (area == Area::kProgram && !content.empty()) must(content == with_checksum(content));
  return content;
}

void start_twice(Store* store) {
  start(store);
  Content first_contents[kAreas];
  for (uint8_t k = 0; k < kAreas; k++)
    first_contents[k] = valid_content(*store, static_cast<Area>(k));
  const uint32_t writes = memory.writes;
  start(store);
  for (uint8_t k = 0; k < kAreas; k++)
    must(valid_content(*store, static_cast<Area>(k)) == first_contents[k]);
  // The first start has settled it. A byte that a cut has left unstable may say that a slot is
  // empty, and at the next start something else: then that empties it.
  must(has_cut || memory.writes == writes);
}

}  // namespace

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Input input(data, size);
  seed_random(input.u16());
  has_cut = false;
  memory = Memory();
  memory.fill(input.u8());
  for (uint8_t pieces = input.u8() % 16; pieces > 0; pieces--) {
    const uint16_t place = input.u16() % kMemoryBytes;
    uint8_t count = input.u8();
    for (uint16_t k = place; count > 0 && k < kMemoryBytes; k++, count--) {
      const uint8_t value = input.u8();
      memory.cells[k] = {value, value};
    }
  }
  Store store;
  start_twice(&store);
  for (uint8_t k = 0; k < kMaxActions && input.has_more(); k++) {
    const uint8_t flags = input.u8();
    const bool is_cut = (flags & 0x10) != 0;
    uint16_t cut_after = is_cut ? input.u16() % 512 : 0;
    const TornByte torn_byte = static_cast<TornByte>(input.u8() % kTornBytes);
    const Area area = static_cast<Area>(flags % kAreas);
    const Content old_content = valid_content(store, area);
    const Content new_content =
        area == Area::kProgram ? random_image(input.u8()) : random_record(area);
    Content buffer = new_content;
    must(begin(&store, area, &buffer));
    while (store.is_busy() && !memory.is_off) {
      memory.is_writing = false;
      if (is_cut && cut_after == 0) {
        memory.is_cut_next = true;
        memory.torn_byte = torn_byte;
      }
      const uint32_t writes = memory.writes;
      store.tick(true);
      if (memory.writes != writes && cut_after > 0) cut_after--;
      if ((flags & 0x20) != 0) store.give_up();
    }
    memory.is_writing = false;
    has_cut |= memory.is_off;
    const bool is_whole = !memory.is_off && store.state() == StoreState::kSaved;
    if (is_whole) must(valid_content(store, area) == new_content);
    start_twice(&store);
    const Content content = valid_content(store, area);
    must(is_whole ? content == new_content : content == new_content || content == old_content);
  }
  return 0;
}
