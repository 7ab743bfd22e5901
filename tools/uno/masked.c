// How long interrupts are off: the longest time for each place that turns them off. An interrupt that
// lets others in has several places: its entry, and each later one.

#include "uno.h"

enum { kMaxPlaces = 256, kMaxNested = 16 };

static struct Place {
  uint8_t vector;  // of the interrupt that is at work; 0: the program
  bool is_entry;
  uint32_t pc;  // of the first instruction
  Cycle cycles;
} places[kMaxPlaces];
static int place_count;

static bool is_watched;
static bool has_begun;  // interrupts were on since the reset
static bool is_masked;
static bool is_entry;
static Cycle masked_from;
static uint32_t masked_at;
static uint8_t masked_in;
static Cycle looked_at;
static uint8_t vectors[kMaxNested];  // of the interrupts that are at work
static int depth;

static uint8_t vector_now(void) { return depth > 0 ? vectors[depth - 1] : 0; }

static void begin(bool is_entered, uint32_t at) {
  is_masked = true;
  is_entry = is_entered;
  masked_from = looked_at;
  masked_at = at;
  masked_in = vector_now();
}

static void end(void) {
  is_masked = false;
  if (!has_begun) return;
  const Cycle cycles = avr->cycle - masked_from;
  int k = 0;
  while (k < place_count && (places[k].vector != masked_in || places[k].pc != masked_at)) k++;
  if (k == kMaxPlaces) give_up("interrupts are turned off in too many places");
  if (k == place_count) places[place_count++] = (struct Place){masked_in, is_entry, masked_at, 0};
  if (cycles > places[k].cycles) places[k].cycles = cycles;
}

// To be called after each instruction.
void masked_look(void) {
  const bool is_now = !avr->sreg[S_I];
  if (is_masked && !is_now) end();
  if (!is_masked && is_now) begin(false, avr->pc);
  has_begun |= !is_now;
  looked_at = avr->cycle;
}

static void entered(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  const avr_int_vector_t* vector = param;
  if (!value) {
    if (depth > 0) depth--;
    return;
  }
  if (depth == kMaxNested) give_up("interrupts are too deep");
  vectors[depth++] = vector->vector;
  begin(true, vector->vector);
}

void masked_begin(void) {
  is_watched = true;
  avr->run_cycle_limit = 1;  // the run looks after each instruction
  on_interrupts(entered);
}

bool masked_is_watched(void) { return is_watched; }

void masked_after_reset(void) {
  has_begun = is_masked = false;
  depth = 0;
}

void masked_tell(void) {
  for (int k = 0; k < place_count; k++) {
    tell(avr->cycle, "masked", "\"vector\": %d, \"is_entry\": %s, \"pc\": %u, \"cycles\": %llu",
         places[k].vector, places[k].is_entry ? "true" : "false", (unsigned)places[k].pc,
         (unsigned long long)places[k].cycles);
  }
  tell(avr->cycle, "masked", "\"places\": %d", place_count);
}
