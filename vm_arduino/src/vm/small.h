// Attributes and helpers that keep the machine small and quick on the AVR. Elsewhere the attributes
// have no effect.

#pragma once

#include <stddef.h>
#include <stdint.h>

#include "has_tasks.h"

// Marks a function that is not copied into each of its callers; and one that finds the machine where
// its caller has it, and does not know the address.
#ifdef __AVR__
#define tini_noinline __attribute__((noinline, noclone))
#define tini_noclone __attribute__((noclone))
#else
#define tini_noinline
#define tini_noclone
#endif

// Marks a function that is copied to where it is called, whatever the compiler thinks of it.
#define tini_always_inline inline __attribute__((always_inline))

// Marks a function that only assembly calls, which whole-program optimization would drop.
#ifdef tiniscript_in_assembly
#define tini_called_by_assembly __attribute__((used, externally_visible, noinline))
#else
#define tini_called_by_assembly
#endif

namespace tiniscript {

// Returns the pointer but hides its value from the compiler. For a known object the compiler uses
// full addresses; access through an unknown pointer takes half as much flash.
template <class Type>
inline Type* near(Type* object) {
#ifdef __AVR__
  asm("" : "+r"(object));
#endif
  return object;
}

// Clears 4 bytes `fours` times, at least once.
inline void clear(void* at, uint8_t fours) {
#ifdef __AVR__
  // The compiler's own loop clears one byte at a time or takes more registers.
  asm volatile(
      "1: st %a0+, __zero_reg__\n\tst %a0+, __zero_reg__\n\t"
      "st %a0+, __zero_reg__\n\tst %a0+, __zero_reg__\n\t"
      "dec %1\n\tbrne 1b"
      : "+e"(at), "+r"(fours)
      :
      : "memory");
#else
  __builtin_memset(at, 0, fours * size_t{4});
#endif
}

// Copies bytes in ascending order: `to` may overlap `from` if it lies before it. All of the
// firmware shares it; the C library's memmove takes 54 bytes beside it.
tini_noinline inline void copy_bytes(const void* from, uint8_t* to, uint8_t length) {
  const uint8_t* bytes = static_cast<const uint8_t*>(from);
  while (length-- != 0) *to++ = *bytes++;
}

}  // namespace tiniscript
