"""Lessons: what pupils read and do, and how the virtual robot checks what they have done.

Each lesson is a folder: `lesson.toml` (robot, criteria, how worlds vary), `world.toml`,
`answers.toml` (programs that are right, and typical wrong ones), and the pages of pupils and
teachers in each language. `reader` reads the data, `catalogue` finds folders, `variation` makes a
world of a seed, `running` lets a program drive there, `judging` compares the run with the
criteria, `sentences` says what came of it. `sheet` makes pages to print.
"""
