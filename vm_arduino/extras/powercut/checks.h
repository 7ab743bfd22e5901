// How the store behaves while nobody pulls the plug.

#pragma once

// Returns what is wrong, or nothing.
const char* run_checks();
