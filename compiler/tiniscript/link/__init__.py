"""The computer's half of the link to a robot: frames, receiver, session. No I/O, no clock."""
