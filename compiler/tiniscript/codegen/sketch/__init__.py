"""A program as an Arduino sketch for a robot's pins: C++ that a pupil can read beside it.

`writing` puts a sketch together; `statements` and `expressions` say the program in C++, `wiring`
what the pins of a kit need, `helpers` has the functions that are written where they are used,
`numbers` those that calculate, `names` what things are called and what is said in words.
"""
