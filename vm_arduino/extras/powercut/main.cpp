// Pulls the plug at every write of the store, and looks what is there at the next starts.
//
//   powercut SEED [SIZE|records [STRIDE]]
//
// runs every history with programs of SIZE bytes of code, or with records, and prints how many
// cases it looked at. Without either it looks how the store behaves with its plug in
// (`checks.cpp`). Ends with status 1 at the first thing that must not be.
//
// A case is one or two cuts, each with one of the ways in which the byte that is written may be
// torn, and three starts. The first cut is in a save: at each write, each way. The second is in
// what the first or the second start puts in order, at each write; or in the next save. In saves
// each STRIDEth write is cut. Some cases go on to a third cut, in the next save.

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <vector>

#include "../../src/store/store.h"
#include "checks.h"
#include "contents.h"
#include "memory.h"

using namespace tiniscript;

namespace {

constexpr uint32_t kMaxTicks = 20000;
constexpr uint32_t kThirdCuts = 8;  // one in so many second cuts is followed by a third one

// The robot: what a cut leaves of it, and what it does not.
struct World {
  Memory memory;
  Store store;
};

// What is to be saved: the content of an area.
struct Task {
  Area area;
  Content content;
};

// Where the plug was pulled, and what became of the byte.
struct Cut {
  unsigned place;
  unsigned torn_byte;
};

// What is being looked at, for a mistake.
const char* history;
std::vector<Cut> cuts;

unsigned long cases;
unsigned long whole_saves;
uint16_t most_erases;
uint32_t most_writes;

[[noreturn]] void fail(const char* failure) {
  printf("WRONG %s: %s", history, failure);
  for (const Cut& cut : cuts) printf(", cut %u at %u", cut.torn_byte, cut.place);
  printf("\n");
  exit(1);
}

void tick(Store* store) {
  memory.is_writing = false;
  store->tick(true);
}

// Runs until there is nothing more to do, or the plug is pulled.
void run(Store* store) {
  for (uint32_t ticks = 0; store->is_busy() && !memory.is_off; ticks++) {
    if (ticks > kMaxTicks) fail("it does not end");
    tick(store);
  }
  memory.is_writing = false;
}

// The contents of all areas, those of the one that is looked at apart.
struct ExpectedContents {
  Area area;
  std::vector<Content> allowed;
  Content other_contents[kAreas];
};

// What is there now, all of it.
ExpectedContents expected_now(const Store& store, Area area) {
  ExpectedContents contents;
  contents.area = area;
  for (uint8_t k = 0; k < kAreas; k++)
    contents.other_contents[k] = read(store, static_cast<Area>(k));
  contents.allowed = {contents.other_contents[static_cast<uint8_t>(area)]};
  return contents;
}

// Reads everything after a start. Returns what is in the area that is looked at.
Content check_contents(const Store& store, const ExpectedContents& expected) {
  if (store.state() != StoreState::kIdle) fail("it is not idle after a start");
  for (uint8_t k = 0; k < kAreas; k++) {
    const Area area = static_cast<Area>(k);
    if (area == expected.area) continue;
    if (read(store, area) != expected.other_contents[k]) fail("another area has changed");
  }
  const Content content = read(store, expected.area);
  for (const Content& allowed : expected.allowed) {
    if (content == allowed) return content;
  }
  fail("there is a third thing");
}

void start(Store* store) {
  memory.is_off = false;
  memory.is_cut_next = false;
  store->boot();
  run(store);
}

// A case: three starts find something that is allowed, and all the same.
void check_starts(World world, const ExpectedContents& expected) {
  cases++;
  memory = world.memory;
  Content first_content;
  for (uint8_t k = 0; k < 3; k++) {
    start(&world.store);
    const Content content = check_contents(world.store, expected);
    if (k == 0) first_content = content;
    if (content != first_content) fail("another one at a later start");
  }
}

// Cuts each write of what `world.store` is doing, in each way, and gives what is left to `next`.
// Returns the world at its end.
template <class Next>
World cut_each_write(World world, uint32_t stride, const Next& next) {
  uint32_t number = random_below(stride);
  while (world.store.is_busy()) {
    for (uint8_t k = 0; k < kTornBytes && number % stride == 0; k++) {
      World cut_world = world;
      memory = world.memory;
      memory.is_cut_next = true;
      memory.torn_byte = static_cast<TornByte>(k);
      tick(&cut_world.store);
      if (!memory.is_off) break;  // this tick writes nothing
      cut_world.memory = memory;
      cuts.push_back({memory.cut_place, k});
      next(cut_world);
      cuts.pop_back();
    }
    memory = world.memory;
    const uint32_t writes_before = memory.writes;
    tick(&world.store);
    if (memory.writes != writes_before) number++;
    world.memory = memory;
  }
  world.memory.is_writing = false;
  return world;
}

ExpectedContents with_allowed(ExpectedContents expected, std::vector<Content> allowed) {
  expected.allowed = std::move(allowed);
  return expected;
}

// Starts, and pulls the plug in the next save, which may be that of what is there.
void cut_next(World world, const ExpectedContents& expected, Task next_task, uint32_t stride) {
  memory = world.memory;
  start(&world.store);
  const Content content = check_contents(world.store, expected);
  if (!begin(&world.store, next_task.area, &next_task.content)) fail("the next save is refused");
  world.memory = memory;
  const ExpectedContents next_expected = with_allowed(expected, {content, next_task.content});
  world =
      cut_each_write(world, stride, [&](const World& cut) { check_starts(cut, next_expected); });
  if (world.store.state() == StoreState::kFailed) fail("the next save fails");
  check_starts(world, with_allowed(expected, {next_task.content}));
}

// The second cut, where the first has left `world`, and sometimes a third one.
void second_cuts(const World& world, const ExpectedContents& expected, const Task& next_task,
                 uint32_t stride) {
  check_starts(world, expected);
  World started_world = world;
  ExpectedContents next_expected = expected;
  for (uint8_t k = 0; k < 2; k++) {  // in the first start, and in the second
    started_world.memory.is_off = false;
    started_world.memory.is_cut_next = false;
    started_world.store.boot();
    started_world = cut_each_write(started_world, 1, [&](const World& cut) {
      check_starts(cut, next_expected);
      if (random_below(kThirdCuts) == 0) cut_next(cut, next_expected, next_task, stride);
    });
    memory = started_world.memory;
    next_expected = with_allowed(expected, {check_contents(started_world.store, next_expected)});
  }
  cut_next(world, expected, next_task, stride);
}

// Everything that can happen to one task, in a world whose store is idle.
void cut_everything(const char* name, World world, Task task,
                    const std::vector<Content>& next_contents, uint32_t stride,
                    const std::vector<Content>& other_allowed = {}) {
  history = name;
  memory = world.memory;
  ExpectedContents expected = expected_now(world.store, task.area);
  memset(erases, 0, sizeof erases);
  if (!begin(&world.store, task.area, &task.content)) fail("a save is refused");
  expected.allowed.push_back(task.content);
  expected.allowed.insert(expected.allowed.end(), other_allowed.begin(), other_allowed.end());

  // once without a cut, for the wear
  World saved_world = world;
  memory.writes = 0;
  run(&saved_world.store);
  saved_world.memory = memory;
  for (uint16_t count : erases) most_erases = count > most_erases ? count : most_erases;
  most_writes = memory.writes > most_writes ? memory.writes : most_writes;
  whole_saves++;
  check_starts(saved_world, with_allowed(expected, {task.content}));

  size_t turn = 0;
  cut_each_write(world, stride, [&](const World& cut) {
    second_cuts(cut, expected, {task.area, next_contents[turn++ % next_contents.size()]}, stride);
  });
}

// A world after these tasks, all done.
World world_after(uint8_t fill, std::vector<Task> tasks) {
  World world;
  memory = Memory();
  memory.fill(fill);
  if (fill == 1) {
    for (Memory::Cell& cell : memory.cells) {
      cell.value = cell.other_value = static_cast<uint8_t>(random_below(0x100));
    }
  }
  start(&world.store);
  for (Task& task : tasks) {
    if (!begin(&world.store, task.area, &task.content)) fail("a save before is refused");
    run(&world.store);
    if (read(world.store, task.area) != task.content) fail("a save before does not save");
  }
  start(&world.store);
  world.memory = memory;
  return world;
}

// A world in which a save was given up after so many of its marks.
World world_after_give_up(World world, Content content, uint8_t marks) {
  memory = world.memory;
  Task task = {Area::kProgram, content};
  if (!begin(&world.store, task.area, &task.content)) fail("a save before is refused");
  for (uint32_t ticks = 0; ticks < kMaxTicks; ticks++) {
    memory.is_writing = false;
    const bool is_ready = world.store.is_ready_to_commit();
    if (is_ready && marks == 0) break;
    if (is_ready) marks--;
    world.store.tick(is_ready);
  }
  world.store.give_up();
  if (world.store.is_busy()) fail("it is not given up");
  world.memory = memory;
  return world;
}

// A start empties a slot that is whole but for its marks. Two cuts may give it back, at worst, the
// two bytes that say whether it counts: cut while its mark becomes 255, and, at the next start,
// while its generation does. It must not come back.
void tear_emptied(World world) {
  history = "what was given up is emptied";
  const uint16_t place = place_of(world.store.current_slot(Area::kProgram) ^ 1);
  const uint8_t generation = world.memory.cells[place].value;
  const uint8_t mark = generation ^ 0xa5;
  memory = world.memory;
  const ExpectedContents expected = expected_now(world.store, Area::kProgram);
  start(&world.store);
  world.memory = memory;
  world.memory.cells[place] = {generation, generation};
  world.memory.cells[place + 1] = {mark, mark};
  const unsigned random_byte = static_cast<unsigned>(TornByte::kRandom);
  cuts = {{place + 1U, random_byte}, {place, random_byte}};
  check_starts(world, expected);
  cuts.clear();
}

void programs(uint16_t size, uint32_t stride) {
  const Area area = Area::kProgram;
  const Content a = random_image(size);
  const Content b = random_image(size);
  const Content c = random_image(size);
  const Content d = random_image(static_cast<uint16_t>(size / 2));
  Content e = a;
  e.back() ^= 1;
  e = with_checksum(e);
  const Task record = {Area::kFault, random_record(Area::kFault)};
  const Task identity = {Area::kIdentity, random_record(Area::kIdentity)};
  const Task owner = {Area::kOwner, random_record(Area::kOwner)};
  std::vector<Task> saves;
  for (uint8_t k = 0; k < 62; k++) saves.push_back({area, k % 2 == 0 ? a : b});

  cut_everything("the first save", world_after(0xff, {}), {area, a}, {b, a}, stride);
  cut_everything("the second save", world_after(0xff, {identity, {area, a}}), {area, b}, {c, b, a},
                 stride);
  cut_everything("the third save", world_after(0xff, {{area, a}, record, owner, {area, b}}),
                 {area, c}, {d, c, b, a}, stride);
  cut_everything("what was there before the last", world_after(0xff, {{area, a}, {area, b}}),
                 {area, a}, {c, a, b}, stride);
  cut_everything("nearly what was there before the last", world_after(0xff, {{area, a}, {area, b}}),
                 {area, e}, {a, e, c}, stride);
  cut_everything("a shorter one", world_after(0xff, {{area, a}, {area, b}}), {area, d}, {c, d, b},
                 stride);
  cut_everything("a longer one", world_after(0xff, {{area, d}, {area, b}}), {area, a}, {c, a, d},
                 stride);
  cut_everything("the 63rd save", world_after(0xff, saves), {area, c}, {d, b}, stride);
  saves.push_back({area, a});
  cut_everything("the 64th save", world_after(0xff, saves), {area, c}, {d, a}, stride);
  saves.push_back({area, b});
  cut_everything("the 65th save", world_after(0xff, saves), {area, c}, {d, b}, stride);
  cut_everything("a memory of zeros", world_after(0, {}), {area, a}, {b, a}, stride);
  cut_everything("a memory of anything", world_after(1, {}), {area, a}, {b, a}, stride);
  const World two = world_after(0xff, {{area, a}, {area, b}});
  cut_everything("a save behind one that was given up", world_after_give_up(two, c, 0), {area, d},
                 {c, d, b}, stride);
  cut_everything("a save behind one with a mark that was given up", world_after_give_up(two, c, 1),
                 {area, d}, {c, d, b}, stride, {c});
  cut_everything("a save behind one with two marks that was given up",
                 world_after_give_up(two, c, 2), {area, d}, {c, d, b}, stride, {c});
  cut_everything("what was given up", world_after_give_up(two, c, 0), {area, c}, {d, c, b}, stride);
  tear_emptied(world_after_give_up(two, c, 0));
}

void records(Area area, uint32_t stride) {
  const Content a = random_record(area);
  const Content b = random_record(area);
  const Content c = random_record(area);
  const Task program = {Area::kProgram, random_image(20)};
  cut_everything("the first record", world_after(0xff, {program}), {area, a}, {b, a}, stride);
  cut_everything("the second record", world_after(0xff, {program, {area, a}}), {area, b}, {c, b, a},
                 stride);
  cut_everything("the third record", world_after(0xff, {{area, a}, {area, b}, program}), {area, c},
                 {a, b, c}, stride);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2 || count > 4) return 2;
  seed_random(static_cast<uint32_t>(atoi(arguments[1])));
  const uint32_t stride = count < 4 ? 1 : static_cast<uint32_t>(atoi(arguments[3]));
  if (count == 2) {
    const char* const failed_check = run_checks();
    if (failed_check != nullptr) {
      printf("WRONG %s\n", failed_check);
      return 1;
    }
  } else if (strcmp(arguments[2], "records") == 0) {
    records(Area::kIdentity, stride);
    records(Area::kFault, stride);
    records(Area::kOwner, stride);
  } else {
    programs(static_cast<uint16_t>(atoi(arguments[2])), stride);
  }
  printf("CASES %lu\nSAVES %lu\nMAX_ERASES %u\nMAX_WRITES %u\n", cases, whole_saves,
         static_cast<unsigned>(most_erases), static_cast<unsigned>(most_writes));
}
