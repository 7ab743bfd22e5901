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

constexpr uint32_t kMostTicks = 20000;
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
  unsigned torn;
};

// What is being looked at, for a mistake.
const char* history;
std::vector<Cut> cuts;

unsigned long cases;
unsigned long whole_saves;
uint16_t most_erases;
uint32_t most_writes;

[[noreturn]] void wrong(const char* what) {
  printf("WRONG %s: %s", history, what);
  for (const Cut& cut : cuts) printf(", cut %u at %u", cut.torn, cut.place);
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
    if (ticks > kMostTicks) wrong("it does not end");
    tick(store);
  }
  memory.is_writing = false;
}

// The contents of all areas, those of the one that is looked at apart.
struct ExpectedContents {
  Area area;
  std::vector<Content> allowed;
  Content others[kAreas];
};

// What is there now, all of it.
ExpectedContents expected_now(const Store& store, Area area) {
  ExpectedContents found;
  found.area = area;
  for (uint8_t k = 0; k < kAreas; k++) found.others[k] = read(store, static_cast<Area>(k));
  found.allowed = {found.others[static_cast<uint8_t>(area)]};
  return found;
}

// Reads everything after a start. Returns what is in the area that is looked at.
Content look(const Store& store, const ExpectedContents& expected) {
  if (store.state() != StoreState::kIdle) wrong("it is not idle after a start");
  for (uint8_t k = 0; k < kAreas; k++) {
    const Area area = static_cast<Area>(k);
    if (area == expected.area) continue;
    if (read(store, area) != expected.others[k]) wrong("another area has changed");
  }
  const Content content = read(store, expected.area);
  for (const Content& allowed : expected.allowed) {
    if (content == allowed) return content;
  }
  wrong("there is a third thing");
}

void start(Store* store) {
  memory.is_off = false;
  memory.is_cut_next = false;
  store->boot();
  run(store);
}

// A case: three starts find something that is allowed, and all the same.
void starts(World world, const ExpectedContents& expected) {
  cases++;
  memory = world.memory;
  Content first;
  for (uint8_t k = 0; k < 3; k++) {
    start(&world.store);
    const Content content = look(world.store, expected);
    if (k == 0) first = content;
    if (content != first) wrong("another one at a later start");
  }
}

// Cuts each write of what `world.store` is doing, in each way, and gives what is left to `next`.
// Returns the world at its end.
template <class Next>
World cut_each_write(World world, uint32_t stride, const Next& next) {
  uint32_t number = random_below(stride);
  while (world.store.is_busy()) {
    for (uint8_t k = 0; k < kTorn && number % stride == 0; k++) {
      World cut = world;
      memory = world.memory;
      memory.is_cut_next = true;
      memory.torn = static_cast<Torn>(k);
      tick(&cut.store);
      if (!memory.is_off) break;  // this tick writes nothing
      cut.memory = memory;
      cuts.push_back({memory.cut_place, k});
      next(cut);
      cuts.pop_back();
    }
    memory = world.memory;
    const uint32_t before = memory.writes;
    tick(&world.store);
    if (memory.writes != before) number++;
    world.memory = memory;
  }
  world.memory.is_writing = false;
  return world;
}

ExpectedContents with(ExpectedContents expected, std::vector<Content> allowed) {
  expected.allowed = std::move(allowed);
  return expected;
}

// Starts, and pulls the plug in the next save, which may be that of what is there.
void cut_next(World world, const ExpectedContents& expected, Task next, uint32_t stride) {
  memory = world.memory;
  start(&world.store);
  const Content content = look(world.store, expected);
  if (!begin(&world.store, next.area, &next.content)) wrong("the next save is refused");
  world.memory = memory;
  const ExpectedContents now = with(expected, {content, next.content});
  world = cut_each_write(world, stride, [&](const World& cut) { starts(cut, now); });
  if (world.store.state() == StoreState::kFailed) wrong("the next save fails");
  starts(world, with(expected, {next.content}));
}

// The second cut, where the first has left `world`, and sometimes a third one.
void second_cuts(const World& world, const ExpectedContents& expected, const Task& next, uint32_t stride) {
  starts(world, expected);
  World started = world;
  ExpectedContents now = expected;
  for (uint8_t k = 0; k < 2; k++) {  // in the first start, and in the second
    started.memory.is_off = false;
    started.memory.is_cut_next = false;
    started.store.boot();
    started = cut_each_write(started, 1, [&](const World& cut) {
      starts(cut, now);
      if (random_below(kThirdCuts) == 0) cut_next(cut, now, next, stride);
    });
    memory = started.memory;
    now = with(expected, {look(started.store, now)});
  }
  cut_next(world, expected, next, stride);
}

// Everything that can happen to one task, in a world whose store is idle.
void cut_everything(const char* name, World world, Task task, const std::vector<Content>& nexts,
                    uint32_t stride, const std::vector<Content>& also = {}) {
  history = name;
  memory = world.memory;
  ExpectedContents expected = expected_now(world.store, task.area);
  memset(erases, 0, sizeof erases);
  if (!begin(&world.store, task.area, &task.content)) wrong("a save is refused");
  expected.allowed.push_back(task.content);
  expected.allowed.insert(expected.allowed.end(), also.begin(), also.end());

  // once without a cut, for the wear
  World whole = world;
  memory.writes = 0;
  run(&whole.store);
  whole.memory = memory;
  for (uint16_t count : erases) most_erases = count > most_erases ? count : most_erases;
  most_writes = memory.writes > most_writes ? memory.writes : most_writes;
  whole_saves++;
  starts(whole, with(expected, {task.content}));

  size_t turn = 0;
  cut_each_write(world, stride, [&](const World& cut) {
    second_cuts(cut, expected, {task.area, nexts[turn++ % nexts.size()]}, stride);
  });
}

// A world after these tasks, all done.
World after(uint8_t fill, std::vector<Task> tasks) {
  World world;
  memory = Memory();
  memory.fill(fill);
  if (fill == 1) {
    for (Memory::Cell& cell : memory.cells) {
      cell.value = cell.other = static_cast<uint8_t>(random_below(0x100));
    }
  }
  start(&world.store);
  for (Task& task : tasks) {
    if (!begin(&world.store, task.area, &task.content)) wrong("a save before is refused");
    run(&world.store);
    if (read(world.store, task.area) != task.content) wrong("a save before does not save");
  }
  start(&world.store);
  world.memory = memory;
  return world;
}

// A world in which a save was given up after so many of its marks.
World given_up(World world, Content content, uint8_t marks) {
  memory = world.memory;
  Task task = {Area::kProgram, content};
  if (!begin(&world.store, task.area, &task.content)) wrong("a save before is refused");
  for (uint32_t ticks = 0; ticks < kMostTicks; ticks++) {
    memory.is_writing = false;
    const bool is_ready = world.store.is_ready_to_commit();
    if (is_ready && marks == 0) break;
    if (is_ready) marks--;
    world.store.tick(is_ready);
  }
  world.store.give_up();
  if (world.store.is_busy()) wrong("it is not given up");
  world.memory = memory;
  return world;
}

// A start empties a slot that is whole but for its marks. Two cuts may give it back, at worst, the
// two bytes that say whether it counts: cut while its mark becomes 255, and, at the next start,
// while its generation does. It must not come back.
void tear_emptied(World world) {
  history = "what was given up is emptied";
  const uint16_t place = place_of(world.store.used(Area::kProgram) ^ 1);
  const uint8_t generation = world.memory.cells[place].value;
  const uint8_t mark = generation ^ 0xa5;
  memory = world.memory;
  const ExpectedContents expected = expected_now(world.store, Area::kProgram);
  start(&world.store);
  world.memory = memory;
  world.memory.cells[place] = {generation, generation};
  world.memory.cells[place + 1] = {mark, mark};
  const unsigned torn = static_cast<unsigned>(Torn::kRandom);
  cuts = {{place + 1U, torn}, {place, torn}};
  starts(world, expected);
  cuts.clear();
}

void programs(uint16_t size, uint32_t stride) {
  const Area area = Area::kProgram;
  const Content a = some_image(size);
  const Content b = some_image(size);
  const Content c = some_image(size);
  const Content d = some_image(static_cast<uint16_t>(size / 2));
  Content e = a;
  e.back() ^= 1;
  e = checked(e);
  const Task record = {Area::kFault, some_record(Area::kFault)};
  const Task identity = {Area::kIdentity, some_record(Area::kIdentity)};
  const Task owner = {Area::kOwner, some_record(Area::kOwner)};
  std::vector<Task> many;
  for (uint8_t k = 0; k < 62; k++) many.push_back({area, k % 2 == 0 ? a : b});

  cut_everything("the first save", after(0xff, {}), {area, a}, {b, a}, stride);
  cut_everything("the second save", after(0xff, {identity, {area, a}}), {area, b}, {c, b, a},
                 stride);
  cut_everything("the third save", after(0xff, {{area, a}, record, owner, {area, b}}), {area, c},
                 {d, c, b, a}, stride);
  cut_everything("what was there before the last", after(0xff, {{area, a}, {area, b}}), {area, a},
                 {c, a, b}, stride);
  cut_everything("nearly what was there before the last", after(0xff, {{area, a}, {area, b}}),
                 {area, e}, {a, e, c}, stride);
  cut_everything("a shorter one", after(0xff, {{area, a}, {area, b}}), {area, d}, {c, d, b},
                 stride);
  cut_everything("a longer one", after(0xff, {{area, d}, {area, b}}), {area, a}, {c, a, d}, stride);
  cut_everything("the 63rd save", after(0xff, many), {area, c}, {d, b}, stride);
  many.push_back({area, a});
  cut_everything("the 64th save", after(0xff, many), {area, c}, {d, a}, stride);
  many.push_back({area, b});
  cut_everything("the 65th save", after(0xff, many), {area, c}, {d, b}, stride);
  cut_everything("a memory of zeros", after(0, {}), {area, a}, {b, a}, stride);
  cut_everything("a memory of anything", after(1, {}), {area, a}, {b, a}, stride);
  const World two = after(0xff, {{area, a}, {area, b}});
  cut_everything("a save behind one that was given up", given_up(two, c, 0), {area, d}, {c, d, b},
                 stride);
  cut_everything("a save behind one with a mark that was given up", given_up(two, c, 1), {area, d},
                 {c, d, b}, stride, {c});
  cut_everything("a save behind one with two marks that was given up", given_up(two, c, 2),
                 {area, d}, {c, d, b}, stride, {c});
  cut_everything("what was given up", given_up(two, c, 0), {area, c}, {d, c, b}, stride);
  tear_emptied(given_up(two, c, 0));
}

void records(Area area, uint32_t stride) {
  const Content a = some_record(area);
  const Content b = some_record(area);
  const Content c = some_record(area);
  const Task program = {Area::kProgram, some_image(20)};
  cut_everything("the first record", after(0xff, {program}), {area, a}, {b, a}, stride);
  cut_everything("the second record", after(0xff, {program, {area, a}}), {area, b}, {c, b, a},
                 stride);
  cut_everything("the third record", after(0xff, {{area, a}, {area, b}, program}), {area, c},
                 {a, b, c}, stride);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2 || count > 4) return 2;
  seed_random(static_cast<uint32_t>(atoi(arguments[1])));
  const uint32_t stride = count < 4 ? 1 : static_cast<uint32_t>(atoi(arguments[3]));
  if (count == 2) {
    const char* const broken = run_checks();
    if (broken != nullptr) {
      printf("WRONG %s\n", broken);
      return 1;
    }
  } else if (strcmp(arguments[2], "records") == 0) {
    records(Area::kIdentity, stride);
    records(Area::kFault, stride);
    records(Area::kOwner, stride);
  } else {
    programs(static_cast<uint16_t>(atoi(arguments[2])), stride);
  }
  printf("CASES %lu\nSAVES %lu\nMOST_ERASES %u\nMOST_WRITES %u\n", cases, whole_saves,
         static_cast<unsigned>(most_erases), static_cast<unsigned>(most_writes));
}
