// What the machine asks of the robot, of which a virtual robot sees what they show.
//
// Stands for `vm_robot.cpp` and `vm_tasks.cpp` in its module. What a program shows goes over the link, and the
// firmware tells nobody else: so it is asked in between, by another name.

#define robot_show watched_show

#include "../../src/vm/vm_robot.cpp"
#include "../../src/vm/vm_tasks.cpp"
