// Which machines have TASK and WHEN, in one place for C++ and assembly.
//
// Tasks take about 2,880 bytes of flash and 127 of RAM. On an Uno the sketch is 1,320 bytes too
// long with them; without owners it fits, but not under a Nano's old bootloader. So an Uno and a
// Nano have none, nor have virtual robots like an Uno (`tiniscript_no_tasks`).

#ifndef TINISCRIPT_VM_HAS_TASKS_H_
#define TINISCRIPT_VM_HAS_TASKS_H_

#if !defined(tiniscript_no_tasks) && (!defined(__AVR__) || defined(__AVR_ATmega2560__))
#define tiniscript_has_tasks
#endif

#endif  // TINISCRIPT_VM_HAS_TASKS_H_
