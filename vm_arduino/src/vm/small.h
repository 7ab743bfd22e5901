// What keeps the machine small and quick on the AVR. Elsewhere it means nothing more.

#ifndef TINISCRIPT_VM_SMALL_H_
#define TINISCRIPT_VM_SMALL_H_

#include <stddef.h>
#include <stdint.h>

// For a function that is called more than once: without a copy for each call.
#ifdef __AVR__
#define tini_noinline __attribute__((noinline, noclone))
#else
#define tini_noinline
#endif

namespace tiniscript {

// Returns the pointer. Where a program has one object of a kind, the compiler knows where it lies
// and reaches each part by its full address; through a pointer that it knows nothing of, that
// takes half as much flash.
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
  // a loop of the compiler clears one at a time, or takes more registers
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

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_SMALL_H_
