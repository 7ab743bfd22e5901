// Which machines have TASK and WHEN, in one place for C++ and assembly.
//
// Tasks take about 2,750 bytes of flash and 130 of RAM: an Uno and a Nano have not that much left,
// nor have virtual robots like an Uno (`tiniscript_no_tasks`).

#ifndef TINISCRIPT_VM_HAS_TASKS_H_
#define TINISCRIPT_VM_HAS_TASKS_H_

#if !defined(tiniscript_no_tasks) && (!defined(__AVR__) || defined(__AVR_ATmega2560__))
#define tiniscript_has_tasks
#endif

#endif  // TINISCRIPT_VM_HAS_TASKS_H_
