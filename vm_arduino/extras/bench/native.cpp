// Runs the works of `workloads.py` as C, compiled for a simulated ATmega328P, and says how many
// cycles they took: what is beside the machine's.
//
// Numbers are int32_t in RAM, so that each is loaded and stored as a variable of TiniScript is.
// They are whole ones; one work is also there in thousandths, with int64_t where that needs it. The
// request: which work, how many times around its loop, and readings.

#include "counter.h"
#include "simulated.h"

namespace {

constexpr uint8_t kSlice = 50;       // times around a loop between two looks at the timers
constexpr uint8_t kMostReadings = 8;  // all are told

int32_t readings[kMostReadings];
uint8_t taken = 0;
volatile int32_t a, d, e, k, n, p, q, x, y;
volatile int8_t left, right;  // what motors were told

__attribute__((noinline)) int32_t read_sensor() {
  const int32_t reading = readings[taken];
  taken = static_cast<uint8_t>((taken + 1) % kMostReadings);
  return reading;
}

__attribute__((noinline)) void motors(int8_t to_left, int8_t to_right) {
  left = to_left;
  right = to_right;
}

int8_t percent(int32_t power) {
  return static_cast<int8_t>(power < -100 ? -100 : power > 100 ? 100 : power);
}

__attribute__((noinline)) void count_up() { x = x + 1; }

void prepare_one() { k = read_sensor(); }

void prepare_three() {
  p = read_sensor();
  q = read_sensor();
  n = read_sensor();
}

void nothing() {}

void add_variable() { x = x + k; }

void add_constant() { x = x + 3; }

void compare_and_count() {
  d = d + 1;
  if (d > 500) e = e + 1;
}

void calculate() {
  y = y + a * p;
  y = y / q;
  y = y % n;
  a = a + 1;
}

// The nearest number of a quotient, half away from zero.
int32_t nearest(int64_t dividend, int32_t divisor) {
  const int64_t half = divisor / 2;
  return static_cast<int32_t>((dividend + (dividend < 0 ? -half : half)) / divisor);
}

void calculate_thousandths() {
  y = y + nearest(static_cast<int64_t>(a) * p, 1000);
  y = nearest(static_cast<int64_t>(y) * 1000, q);
  y = y % n;
  a = a + 1000;
}

void avoid() {
  motors(80, 80);
  d = read_sensor();
  if (d < 10) {
    motors(0, 0);
    motors(60, -60);
    n = n + 1;
  }
}

void follow() {
  e = read_sensor() - 5;
  motors(percent(50 + k * e), percent(50 - k * e));
}

void call() { count_up(); }

struct Work {
  void (*before)();
  void (*body)(uint8_t times);
  const volatile int32_t* shown[2];
};

template <void (*body)()>
__attribute__((noinline)) void around(uint8_t times) {
  while (times-- != 0) body();
}

const Work kWorks[] = {
    {prepare_one, around<add_variable>, {&x, nullptr}},
    {nothing, around<add_constant>, {&x, nullptr}},
    {nothing, around<compare_and_count>, {&d, &e}},
    {prepare_three, around<calculate>, {&y, &a}},
    {prepare_three, around<calculate_thousandths>, {&y, &a}},
    {nothing, around<avoid>, {&n, nullptr}},
    {prepare_one, around<follow>, {&e, nullptr}},
    {nothing, around<call>, {&x, nullptr}},
};

void run() {
  const Work& work = kWorks[simulated::next_byte()];
  uint16_t left_to_do = simulated::next_word();
  for (int32_t& reading : readings) reading = static_cast<int32_t>(simulated::next_long());
  work.before();
  const uint32_t of_looking = counter::begin();
  uint32_t total = 0;
  uint32_t longest = 0;
  while (left_to_do != 0 && longest < counter::kLongest) {
    const uint8_t times = left_to_do < kSlice ? static_cast<uint8_t>(left_to_do) : kSlice;
    counter::start();
    work.body(times);
    const uint32_t cycles = counter::cycles() - of_looking;
    total += cycles;
    if (cycles > longest) longest = cycles;
    left_to_do = static_cast<uint16_t>(left_to_do - times);
  }
  for (const volatile int32_t* place : work.shown) {
    if (place != nullptr) simulated::say("SHOW", *place);
  }
  simulated::say("LEFT", left);
  simulated::say("RIGHT", right);
  simulated::say("UNDONE", left_to_do);
  simulated::say("CYCLES", static_cast<int32_t>(total));
}

}  // namespace

int main() {
  simulated::begin();
  run();
  simulated::end();
}
