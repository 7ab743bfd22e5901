// What keeps the machine small on the AVR. Elsewhere it means nothing.

#ifndef TINISCRIPT_VM_SMALL_H_
#define TINISCRIPT_VM_SMALL_H_

// For a function that is called more than once: without a copy for each call.
#ifdef __AVR__
#define one_copy __attribute__((noinline, noclone))
#else
#define one_copy
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

}  // namespace tiniscript

#endif  // TINISCRIPT_VM_SMALL_H_
