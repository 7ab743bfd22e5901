// What the machine asks of the robot, of which a virtual robot sees what they show.
//
// Stands for `actions.cpp` and `task_steps.cpp` in its module. What a program shows goes over the link, and the
// firmware tells nobody else: so it is asked in between, by another name.

#define robot_show watched_show

#include "../../src/vm/actions.cpp"
#include "../../src/vm/task_steps.cpp"
