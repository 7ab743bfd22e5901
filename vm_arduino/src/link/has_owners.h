// Whether this robot knows owners. The code that the Arduino IDE's own options make for an Uno or a Nano
// is too long for that; platformio.ini has shorter ones, and says tiniscript_with_owners.

#pragma once

namespace tiniscript {

#if defined(tiniscript_without_owners) || \
    (defined(__AVR_ATmega328P__) && !defined(tiniscript_with_owners))
constexpr bool kHasOwners = false;
#else
constexpr bool kHasOwners = true;
#endif

}  // namespace tiniscript
