// Pulls the plug of an ESP32 at every write of NVS, and looks what the store finds at the next
// starts.
//
//   powercut SEED SIZE [PAGES]
//
// runs saves of programs of SIZE bytes of code and of records. Each write of a save is cut, in each
// way in which NVS may leave its entry; then each write of what the next start puts in order; then
// each write of the next save. Prints how many cases it looked at. Ends with status 1 at the first
// thing that must not be. With PAGES of NVS it only saves, and cuts nothing.

#include <stdio.h>
#include <stdlib.h>

#include <vector>

#include "../../src/boards/esp32/nvs.cpp"
#include "../../src/store/store.h"
#include "../powercut/contents.h"
#include "simulated_chip.h"

using namespace tiniscript;

void tiniscript::ultrasonic_forget() {}  // there is none

namespace {

typedef std::map<std::string, std::string> Entries;

constexpr uint32_t kMostTicks = 60000;

unsigned long cases;
uint32_t most_writes;
const char* doing = "";

[[noreturn]] void wrong(const char* what) {
  printf("WRONG %s: %s\n", doing, what);
  exit(1);
}

// What a reset makes of `nvs.cpp`.
void forget() {
  is_loaded = false;
  is_open = false;
  chip.nvs_handles = 0;
  blob_slot = kSlots;
  is_dirty = false;
  __builtin_memset(blob, 0, sizeof blob);
}

void run(Store* store) {
  for (uint32_t ticks = 0; store->is_busy() && !chip.is_off; ticks++) {
    if (ticks > kMostTicks) wrong("it does not end");
    if (nvm_is_ready()) store->tick(true);
  }
}

void power_on(Entries entries, uint32_t cut_at, TornEntry torn) {
  chip.entries = entries;
  chip.nvs_writes = 0;
  chip.cut_at = cut_at;
  chip.torn = torn;
  chip.is_off = false;
  forget();
}

// Three starts find something that is allowed, and all the same.
void starts(const Entries& entries, Area area, const std::vector<Content>& allowed) {
  cases++;
  Content first;
  power_on(entries, 0, TornEntry::kOld);
  for (int k = 0; k < 3; k++) {
    Store store;
    forget();
    store.boot();
    run(&store);
    const Content content = read(store, area);
    bool is_allowed = false;
    for (const Content& one : allowed) is_allowed = is_allowed || content == one;
    if (!is_allowed) wrong(content.empty() ? "nothing is there" : "there is a third thing");
    if (k > 0 && content != first) wrong("another one at a later start");
    first = content;
  }
}

// Boots from `entries` and saves `content`; cut at the given write of both. Returns what is left.
Entries saved(const Entries& entries, Area area, Content content, uint32_t cut_at, TornEntry torn,
              bool* has_ended) {
  power_on(entries, cut_at, torn);
  Store store;
  store.boot();
  run(&store);
  const uint32_t before = chip.nvs_writes;
  if (!chip.is_off) {
    if (!begin(&store, area, &content)) wrong("a save is refused");
    run(&store);
    if (!chip.is_off && store.state() != StoreState::kSaved) wrong("a save fails");
  }
  *has_ended = !chip.is_off;
  const uint32_t writes = chip.nvs_writes - before;
  if (*has_ended && writes > most_writes) most_writes = writes;
  return chip.entries;
}

const TornEntry kEach[] = {TornEntry::kOld, TornEntry::kNew, TornEntry::kLost};

// Cuts each write of a save; then each write of the next one, with what its start puts in order.
void cut_everything(const Entries& before, Area area, const Content& old, const Content& content,
                    const Content& next, int depth) {
  for (TornEntry torn : kEach) {
    bool has_ended = false;
    for (uint32_t cut_at = 1; !has_ended; cut_at++) {
      const Entries left = saved(before, area, content, cut_at, torn, &has_ended);
      std::vector<Content> allowed = {content};
      if (!has_ended) allowed.push_back(old);
      starts(left, area, allowed);
      if (depth == 0 || has_ended) continue;
      // what counts now, for the next cut
      power_on(left, 0, TornEntry::kOld);
      Store store;
      store.boot();
      run(&store);
      cut_everything(left, area, read(store, area), next, content, depth - 1);
    }
  }
}

void history(const char* name, Area area, const std::vector<Content>& contents) {
  doing = name;
  Entries entries;
  Content old;
  for (size_t k = 0; k + 1 < contents.size(); k++) {
    cut_everything(entries, area, old, contents[k], contents[k + 1], 1);
    bool has_ended = false;
    entries = saved(entries, area, contents[k], 0, TornEntry::kOld, &has_ended);
    old = contents[k];
    starts(entries, area, {old});
  }
}

// A program that somebody edits: its end comes and goes, and a byte of it changes.
std::vector<Content> edited(uint16_t size) {
  const Content whole = some_image(size);
  std::vector<Content> contents;
  for (int k = 0; k < 12; k++) {
    const uint16_t code_bytes = static_cast<uint16_t>(1 + random_below(size));
    Content image(whole.begin(), whole.begin() + kHeaderBytes + code_bytes);
    image[kCodeLengthAt] = static_cast<uint8_t>(code_bytes);
    image[kCodeLengthAt + 1] = static_cast<uint8_t>(code_bytes >> 8);
    image[kHeaderBytes + random_below(code_bytes)] ^= 1;
    contents.push_back(checked(image));
  }
  return contents;
}

// Saves one after the other; nothing is cut.
void save_all(const std::vector<Content>& contents) {
  doing = "programs";
  Entries entries;
  for (const Content& content : contents) {
    bool has_ended = false;
    entries = saved(entries, Area::kProgram, content, 0, TornEntry::kOld, &has_ended);
    starts(entries, Area::kProgram, {content});
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3 && count != 4) return 2;
  seed_random(static_cast<uint32_t>(atoi(arguments[1])));
  const uint16_t size = static_cast<uint16_t>(atoi(arguments[2]));
  const Content a = some_image(size);
  const Content b = some_image(static_cast<uint16_t>(size / 2));
  const Content c = some_image(size);
  if (count == 4) {
    chip.nvs_room = kPageEntries * static_cast<size_t>(atoi(arguments[3]));
    save_all({a, c, a, c, some_image(size), a});
    return 0;
  }
  history("programs", Area::kProgram, {a, b, c, b, c, a});
  save_all(edited(size));
  for (Area area : {Area::kIdentity, Area::kFault, Area::kOwner}) {
    std::vector<Content> records;
    for (int k = 0; k < 4; k++) records.push_back(some_record(area));
    history("records", area, records);
  }
  printf("CASES %lu\nMOST_WRITES %u\n", cases, most_writes);
}
