"""A program as an Arduino sketch for a robot's pins: C++ that a pupil can read beside it.

`writing` puts a sketch together; `statements` and `expressions` write the program in C++, `wiring`
the code for the pins of a kit; `helpers` has functions that are included only if used, `numbers`
those that calculate, `names` the names of things and the texts.
"""
