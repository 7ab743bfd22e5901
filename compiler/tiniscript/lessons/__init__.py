"""Lessons: their texts and tasks, and how the virtual robot checks pupils' programs.

Each lesson is a folder: `lesson.toml` (robot, criteria, how worlds vary), `world.toml`,
`answers.toml` (programs that are right, and typical wrong ones), and the pages of pupils and
teachers in each language. `reader` reads the data, `catalogue` finds folders, `variation` makes a
world from a seed, `running` lets a program drive there, `judging` compares the run with the
criteria, `sentences` describes the result. `sheet` makes pages to print.
"""
