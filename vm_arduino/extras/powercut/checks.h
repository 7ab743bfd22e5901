// How the store behaves while nobody pulls the plug.

#ifndef TINISCRIPT_POWERCUT_CHECKS_H_
#define TINISCRIPT_POWERCUT_CHECKS_H_

// Returns what is wrong, or nothing.
const char* run_checks();

#endif  // TINISCRIPT_POWERCUT_CHECKS_H_
