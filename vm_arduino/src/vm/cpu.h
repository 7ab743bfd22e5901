// The services that the code of all chips needs of the CPU: attributes, tables in flash, quick
// flags.
//
//   tini_progmem             a table that stays in flash, which `flash_byte` and `flash_word` read
//   tini_noinline            a function that is not copied into each of its callers
//   tini_noclone             one that finds the machine where its caller has it
//   tini_always_inline       one that is copied to where it is called, whatever the compiler thinks
//   tini_called_by_assembly  one that whole-program optimization would drop
//   near(object)             the pointer, whose value is hidden from the compiler: for a known object
//                            it uses full addresses, which take twice as much flash
//   clear(at, fours)         clears 4 bytes `fours` times, at least once
//   FlagAt<bit>              a flag, QuickByte<at> a byte: `flags.h` says whose

#pragma once

#define tini_always_inline inline __attribute__((always_inline))

#ifdef __AVR__
#include "cpu_avr.h"
#else
#include "cpu_portable.h"
#endif
