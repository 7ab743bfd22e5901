// What happens at a cycle, whatever it is: one list, behind one timer of libsimavr.

#include <stdlib.h>

#include "uno.h"

struct Entry {
  Cycle when;
  Happening happening;
  void* what;
  struct Entry* next;
};

static struct Entry* first;
static struct Entry* unused;

static void arm(void);

static void take_first(struct Entry** place) {
  struct Entry* entry = *place;
  *place = entry->next;
  entry->next = unused;
  unused = entry;
}

static avr_cycle_count_t run_due(avr_t* chip, avr_cycle_count_t when, void* param) {
  (void)when;
  (void)param;
  while (first && first->when <= chip->cycle) {
    const struct Entry due = *first;
    take_first(&first);
    due.happening(due.when, due.what);
  }
  arm();
  return 0;
}

static void arm(void) {
  if (!first) return;
  const Cycle gone = avr->cycle;
  avr_cycle_timer_register(avr, first->when > gone ? first->when - gone : 0, run_due, NULL);
}

void at_cycle(Cycle when, Happening happening, void* what) {
  if (!unused) {
    enum { kMore = 256 };
    unused = calloc(kMore, sizeof *unused);
    if (!unused) give_up("no memory");
    for (int k = 0; k + 1 < kMore; k++) unused[k].next = &unused[k + 1];
  }
  struct Entry* entry = unused;
  unused = entry->next;
  struct Entry** place = &first;
  while (*place && (*place)->when <= when) place = &(*place)->next;
  *entry = (struct Entry){when, happening, what, *place};
  *place = entry;
  if (first == entry) arm();
}

void cancel(Happening happening, void* what) {
  struct Entry** place = &first;
  while (*place) {
    if ((*place)->happening == happening && (*place)->what == what) {
      take_first(place);
    } else {
      place = &(*place)->next;
    }
  }
}

Cycle next_happening(void) { return first ? first->when : UINT64_MAX; }

void queue_after_reset(void) { arm(); }
