// Whether this robot seals frames. A Mega can, where it is built with tiniscript_with_seals; an Uno and a
// Nano have no room. All other chips do, unless tiniscript_without_seals.

#pragma once

#include "has_owners.h"

#if (defined(tiniscript_with_seals) || !defined(__AVR__)) && !defined(tiniscript_without_seals)
#define tiniscript_seals
#endif

namespace tiniscript {

#ifdef tiniscript_seals
constexpr bool kMaySeal = true;
#else
constexpr bool kMaySeal = false;
#endif

constexpr bool kHasSeals = kMaySeal && kHasOwners;

}  // namespace tiniscript
