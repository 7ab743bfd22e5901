// Whether this robot knows owners. A build for a chip without room leaves them out.

#ifndef TINISCRIPT_LINK_HAS_OWNERS_H_
#define TINISCRIPT_LINK_HAS_OWNERS_H_

namespace tiniscript {

#ifdef tiniscript_without_owners
constexpr bool kHasOwners = false;
#else
constexpr bool kHasOwners = true;
#endif

}  // namespace tiniscript

#endif  // TINISCRIPT_LINK_HAS_OWNERS_H_
