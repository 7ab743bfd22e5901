// The timer of a simulated chip, on a thread of its own.

#pragma once

// From now on `run_timer` alone calls what the timer calls, and not the chip's time.
void take_timer();
void run_timer();
