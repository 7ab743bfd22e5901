// How deep the stack goes: what of the memory nobody has ever written, and the deepest places of
// the program and of interrupts apart. Interrupts come when they come: the deepest one in the
// deepest place may never be seen, and the sum of the two says what is left then.

#include <stdlib.h>
#include <string.h>

#include "uno.h"

enum { kSpl = 0x5d, kSph = 0x5e, kMaxPushed = 3, kSteadyLooks = 3, kMemory = 1 << 16 };

static uint8_t paint[kMemory];
static bool is_watched;
static int interrupts;      // that have been entered and not left
static int interrupted_at;  // where the stack was before them
static int steady_at;       // a place that is one of the stack
static int looked_at;
static int looks;            // that have seen the same
static int deepest_program;  // bytes
static int deepest_interrupt;

static int stack_at(void) { return avr->data[kSpl] | avr->data[kSph] << 8; }

static void note_depth(int at) {
  if (interrupts == 0) {
    if (avr->ramend - at > deepest_program) deepest_program = avr->ramend - at;
  } else if (interrupted_at - at > deepest_interrupt) {
    deepest_interrupt = interrupted_at - at;
  }
}

// To be called after each instruction. A frame is made in two steps, first the high byte of SP and
// then the low one: what is no push or call counts only where it stays.
void stack_look(void) {
  const int at = stack_at();
  looks = at == looked_at ? looks + 1 : 1;
  looked_at = at;
  if (looks < kSteadyLooks && abs(at - steady_at) > kMaxPushed) return;
  steady_at = at;
  note_depth(at);
}

static void entered(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  (void)param;
  if (value && interrupts++ == 0) interrupted_at = stack_at() + avr->address_size;
  if (!value && interrupts > 0) interrupts--;
  steady_at = looked_at = stack_at();
}

void stack_begin(void) {
  is_watched = true;
  avr->run_cycle_limit = 1;  // the run looks after each instruction
  on_interrupts(entered);
}

bool stack_is_watched(void) { return is_watched; }

void stack_after_reset(bool is_power_on) {
  interrupts = 0;
  steady_at = looked_at = stack_at();
  if (is_power_on) memcpy(paint, avr->data, (size_t)avr->ramend + 1);
}

void stack_tell(int from) {
  int end = from;
  while (end <= avr->ramend && avr->data[end] == paint[end]) end++;
  tell(avr->cycle, "stack", "\"untouched\": %d, \"room\": %d, \"program\": %d, \"interrupt\": %d",
       end - from, avr->ramend + 1 - from, deepest_program, deepest_interrupt);
}
