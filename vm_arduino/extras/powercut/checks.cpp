#include "checks.h"

#include "contents.h"
#include "memory.h"

using namespace tiniscript;

namespace {

constexpr uint16_t kNever = 0xffff;  // ticks

// Ticks until nothing is to be done, or so many times. The memory is ready in every third tick.
void run(Store* store, bool may_commit, uint16_t max_ticks = kNever) {
  for (uint16_t k = 0; k < max_ticks && store->is_busy(); k++) {
    memory.is_writing = memory.is_writing && k % 3 != 0;
    store->tick(may_commit);
  }
  memory.is_writing = false;
}

void start(Store* store) {
  store->boot();
  run(store, true);
}

bool save(Store* store, const Content& image) {
  if (!store->begin_save(image.data())) return false;
  run(store, true);
  return store->state() == StoreState::kSaved && read(*store, Area::kProgram) == image;
}

bool has(const Store& store, const Content& image) { return read(store, Area::kProgram) == image; }

}  // namespace

// A line that is not so ends the checks, and is what they return.
#define expect(what) \
  if (!(what)) return #what

const char* run_checks() {
  const Content a = random_image(20);
  const Content b = random_image(20);
  const Content c = random_image(kStoredCodeBytes);
  const Content large_image = random_image(kStoredCodeBytes + 1);
  Content record = random_record(Area::kFault);
  const Content same_record = record;
  Store store;
  Store later_store;
  memory.fill(0xff);

  // an empty memory
  store.boot();
  expect(store.is_busy() && store.state() == StoreState::kSettling);
  expect(!store.begin_save(a.data()));
  run(&store, true);
  expect(store.state() == StoreState::kIdle && memory.writes == 0);
  expect(store.current_slot(Area::kProgram) == kNoSlot && has(store, {}));

  // a save waits for the motors, and says so
  expect(store.begin_save(a.data()) && !store.begin_save(b.data()));
  expect(!store.begin_save_record(Area::kFault, record.data()));
  run(&store, false, 2000);
  expect(store.state() == StoreState::kSaving && store.is_busy());
  start(&later_store);
  expect(has(later_store, {}));
  memory.fill(0xff);
  start(&store);
  expect(save(&store, a) && save(&store, b));
  start(&store);
  expect(has(store, b));

  // while the motors run, the old one counts
  expect(store.begin_save(c.data()));
  run(&store, false, 5000);
  expect(has(store, b));
  later_store = store;
  run(&store, true);
  expect(store.state() == StoreState::kSaved && has(store, c));

  // what is given up was never there, and the next save is whole; only what waits is given up
  start(&store);
  expect(store.begin_save(a.data()));
  store.give_up();
  expect(store.is_busy());
  run(&store, false, 5000);
  expect(store.is_ready_to_commit() && !store.is_committing());
  store.give_up();
  expect(!store.is_busy() && has(store, c) && !store.is_ready_to_commit());
  start(&later_store);
  expect(has(later_store, c));
  expect(store.begin_save(a.data()));
  run(&store, false, 5000);
  store.tick(true);
  expect(store.is_committing() && !store.is_ready_to_commit());
  store.give_up();
  expect(store.is_committing());  // not while a byte is being written
  memory.is_writing = false;
  expect(!store.is_committing());
  store.give_up();
  expect(!store.is_busy() && has(store, c));
  start(&later_store);
  expect(has(later_store, a));
  memory.is_writing = false;
  start(&store);
  expect(save(&store, c) && save(&store, b) && save(&store, c));

  // what is stored already costs nothing
  uint32_t writes = memory.writes;
  expect(save(&store, c) && memory.writes == writes);
  expect(!store.begin_save(large_image.data()));

  // the largest program; then what was there before the last, of which hardly a byte has changed
  start(&store);
  expect(has(store, c));
  writes = memory.writes;
  expect(save(&store, b) && memory.writes - writes == 8);

  // the caller's verdict: the one before counts, and is not written over
  store.refuse();
  expect(has(store, c));
  writes = memory.writes;
  expect(save(&store, a) && has(store, a));
  store.refuse();
  expect(has(store, c));
  store.refuse();
  expect(has(store, {}));
  store.refuse();
  expect(has(store, {}));
  start(&store);
  expect(has(store, a));
  store.refuse();
  store.refuse();
  expect(save(&store, b));
  start(&store);
  expect(has(store, b));

  // a verdict that is taken back
  expect(save(&store, a));
  const uint8_t slot = store.current_slot(Area::kProgram);
  store.refuse();
  expect(has(store, b));
  store.readmit(slot);
  expect(has(store, a));

  // the program before is saved again: nothing of it is touched before the motors stand, and it
  // is not lost where that is given up
  writes = memory.writes;
  for (uint8_t k = 0; k < 2; k++) {
    expect(store.begin_save(b.data()));
    run(&store, false, 2000);
    expect(store.is_ready_to_commit() && !store.is_committing() && memory.writes == writes);
    expect(has(store, a));
    store.give_up();
    expect(!store.is_busy() && has(store, a));
  }
  expect(store.begin_save(b.data()));
  store.tick(true);
  expect(store.is_committing() && memory.writes == writes + 1);
  run(&store, true, 40);  // a few bytes: it soon counts again
  expect(!store.is_busy() && memory.writes == writes + 8 && has(store, b));
  start(&store);
  expect(has(store, b));
  expect(save(&store, a) && memory.writes == writes + 16);
  start(&store);
  expect(has(store, a));
  expect(save(&store, b));

  // where a byte of it has changed by itself it is written anew, all of it
  memory.cells[place_of(store.current_slot(Area::kProgram) ^ 1) + kBodyAt + 20] = {1, 1};
  expect(save(&store, a));
  start(&store);
  expect(has(store, a) && save(&store, b));

  // what is half written over no longer counts
  expect(store.begin_save(c.data()));
  run(&store, false, 5000);
  store.give_up();
  store.refuse();
  expect(has(store, {}));
  start(&store);
  expect(has(store, b) && save(&store, a) && save(&store, b));

  // records: apart from each other and from programs
  expect(store.begin_save_record(Area::kIdentity, record.data()));
  run(&store, true);
  expect(record == same_record && read(store, Area::kIdentity) == record);
  expect(read(store, Area::kFault).empty() && has(store, b));
  record[kNameAt] = static_cast<uint8_t>(record[kNameAt] + 1);
  expect(store.begin_save_record(Area::kFault, record.data()));
  run(&store, true);
  expect(record != same_record);
  start(&store);
  expect(read(store, Area::kIdentity) == same_record && read(store, Area::kFault) == record);

  // a byte that is worn out
  memory.dead_place =
      static_cast<uint16_t>(place_of(store.current_slot(Area::kProgram) ^ 1) + kBodyAt + 30);
  expect(store.begin_save(c.data()));
  run(&store, true);
  expect(store.state() == StoreState::kFailed && has(store, b));
  start(&store);
  expect(has(store, b));
  memory.dead_place = kMemoryBytes;

  // a byte that has changed by itself: the one before counts, and where that has changed too, none
  expect(save(&store, a));
  for (const Content& expected : {b, Content()}) {
    memory.cells[place_of(store.current_slot(Area::kProgram)) + kBodyAt + 20] = {1, 1};
    start(&store);
    expect(has(store, expected));
  }
  return nullptr;
}
