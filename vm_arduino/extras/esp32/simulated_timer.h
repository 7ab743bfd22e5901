// The timer of a simulated chip, on a thread of its own.

#ifndef TINISCRIPT_ESP32_SIMULATED_TIMER_H_
#define TINISCRIPT_ESP32_SIMULATED_TIMER_H_

// From now on `run_timer` alone calls what the timer calls, and not the chip's time.
void take_timer();
void run_timer();

#endif  // TINISCRIPT_ESP32_SIMULATED_TIMER_H_
