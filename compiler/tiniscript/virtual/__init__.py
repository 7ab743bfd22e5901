"""The virtual robot: the robot's own firmware, in a body, in a world of walls, lines and lamps.

`module` runs the firmware (`robot.wasm`), `world` is its surroundings, `driving` calculates its
position, `sensing` its readings, and `robot` combines them, without a clock and without a port.
`simulator` adds both; `line_faults` and `transports` handle the bytes of its line.
"""
