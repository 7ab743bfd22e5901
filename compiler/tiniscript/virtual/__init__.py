"""The virtual robot: the robot's own firmware, in a body, in a world of walls, lines and lamps.

`module` is the firmware (`robot.wasm`), `world` what there is around it, `driving` where it gets
to, `sensing` what it notices there, and `robot` all of them together, without a clock and without
a port. `host` gives it both, and `line_faults`, `tether_time` and `guests` stand in its line.
"""
