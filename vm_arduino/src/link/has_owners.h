// Whether this robot knows owners. The code that the Arduino IDE's own options make for an Uno or a Nano
// is too long for that; platformio.ini has shorter ones, and says tiniscript_with_owners.

#ifndef TINISCRIPT_LINK_HAS_OWNERS_H_
#define TINISCRIPT_LINK_HAS_OWNERS_H_

namespace tiniscript {

#if defined(tiniscript_without_owners) || \
    (defined(__AVR_ATmega328P__) && !defined(tiniscript_with_owners))
constexpr bool kHasOwners = false;
#else
constexpr bool kHasOwners = true;
#endif

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_HAS_OWNERS_H_
