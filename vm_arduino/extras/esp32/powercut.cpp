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

constexpr uint32_t kMaxTicks = 60000;

unsigned long cases;
uint32_t most_writes;
const char* current_case = "";

[[noreturn]] void fail(const char* failure) {
  printf("WRONG %s: %s\n", current_case, failure);
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
    if (ticks > kMaxTicks) fail("it does not end");
    if (nvm_is_ready()) store->tick(true);
  }
}

void power_on(Entries entries, uint32_t cut_write, TornEntry torn_entry) {
  chip.entries = entries;
  chip.nvs_writes = 0;
  chip.cut_write = cut_write;
  chip.torn_entry = torn_entry;
  chip.is_off = false;
  forget();
}

// Three starts find something that is allowed, and all the same.
void check_starts(const Entries& entries, Area area, const std::vector<Content>& allowed) {
  cases++;
  Content first_content;
  power_on(entries, 0, TornEntry::kOld);
  for (int k = 0; k < 3; k++) {
    Store store;
    forget();
    store.boot();
    run(&store);
    const Content content = read(store, area);
    bool is_allowed = false;
    for (const Content& allowed_content : allowed)
      is_allowed = is_allowed || content == allowed_content;
    if (!is_allowed) fail(content.empty() ? "nothing is there" : "there is a third thing");
    if (k > 0 && content != first_content) fail("another one at a later start");
    first_content = content;
  }
}

// Boots from `entries` and saves `content`; cut at the given write of both. Returns what is left.
Entries entries_after_save(const Entries& entries, Area area, Content content, uint32_t cut_write,
                           TornEntry torn_entry, bool* has_ended) {
  power_on(entries, cut_write, torn_entry);
  Store store;
  store.boot();
  run(&store);
  const uint32_t writes_before = chip.nvs_writes;
  if (!chip.is_off) {
    if (!begin(&store, area, &content)) fail("a save is refused");
    run(&store);
    if (!chip.is_off && store.state() != StoreState::kSaved) fail("a save fails");
  }
  *has_ended = !chip.is_off;
  const uint32_t writes = chip.nvs_writes - writes_before;
  if (*has_ended && writes > most_writes) most_writes = writes;
  return chip.entries;
}

const TornEntry kTornEntries[] = {TornEntry::kOld, TornEntry::kNew, TornEntry::kLost};

// Cuts each write of a save; then each write of the next one, with what its start puts in order.
void cut_everything(const Entries& start_entries, Area area, const Content& old_content,
                    const Content& content, const Content& next, int depth) {
  for (TornEntry torn_entry : kTornEntries) {
    bool has_ended = false;
    for (uint32_t cut_write = 1; !has_ended; cut_write++) {
      const Entries cut_entries =
          entries_after_save(start_entries, area, content, cut_write, torn_entry, &has_ended);
      std::vector<Content> allowed = {content};
      if (!has_ended) allowed.push_back(old_content);
      check_starts(cut_entries, area, allowed);
      if (depth == 0 || has_ended) continue;
      // what counts now, for the next cut
      power_on(cut_entries, 0, TornEntry::kOld);
      Store store;
      store.boot();
      run(&store);
      cut_everything(cut_entries, area, read(store, area), next, content, depth - 1);
    }
  }
}

void history(const char* name, Area area, const std::vector<Content>& contents) {
  current_case = name;
  Entries entries;
  Content old_content;
  for (size_t k = 0; k + 1 < contents.size(); k++) {
    cut_everything(entries, area, old_content, contents[k], contents[k + 1], 1);
    bool has_ended = false;
    entries = entries_after_save(entries, area, contents[k], 0, TornEntry::kOld, &has_ended);
    old_content = contents[k];
    check_starts(entries, area, {old_content});
  }
}

// A program that somebody edits: its end comes and goes, and a byte of it changes.
std::vector<Content> edited_programs(uint16_t size) {
  const Content whole_image = random_image(size);
  std::vector<Content> contents;
  for (int k = 0; k < 12; k++) {
    const uint16_t code_bytes = static_cast<uint16_t>(1 + random_below(size));
    Content image(whole_image.begin(), whole_image.begin() + kHeaderBytes + code_bytes);
    image[kCodeLengthAt] = static_cast<uint8_t>(code_bytes);
    image[kCodeLengthAt + 1] = static_cast<uint8_t>(code_bytes >> 8);
    image[kHeaderBytes + random_below(code_bytes)] ^= 1;
    contents.push_back(with_checksum(image));
  }
  return contents;
}

// Saves one after the other; nothing is cut.
void save_all(const std::vector<Content>& contents) {
  current_case = "programs";
  Entries entries;
  for (const Content& content : contents) {
    bool has_ended = false;
    entries = entries_after_save(entries, Area::kProgram, content, 0, TornEntry::kOld, &has_ended);
    check_starts(entries, Area::kProgram, {content});
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3 && count != 4) return 2;
  seed_random(static_cast<uint32_t>(atoi(arguments[1])));
  const uint16_t size = static_cast<uint16_t>(atoi(arguments[2]));
  const Content a = random_image(size);
  const Content b = random_image(static_cast<uint16_t>(size / 2));
  const Content c = random_image(size);
  if (count == 4) {
    chip.nvs_room = kPageEntries * static_cast<size_t>(atoi(arguments[3]));
    save_all({a, c, a, c, random_image(size), a});
    return 0;
  }
  history("programs", Area::kProgram, {a, b, c, b, c, a});
  save_all(edited_programs(size));
  for (Area area : {Area::kIdentity, Area::kFault, Area::kOwner}) {
    std::vector<Content> records;
    for (int k = 0; k < 4; k++) records.push_back(random_record(area));
    history("records", area, records);
  }
  printf("CASES %lu\nMAX_WRITES %u\n", cases, most_writes);
}
