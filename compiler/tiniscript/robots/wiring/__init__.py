"""A robot's wiring for people who build it: a plan from its profile, a drawing, and a page.

`parts` says what each part looks like, `plan` counts the wires, `layout` says where they run,
`drawing` makes SVG of that, `page` writes the text next to it, `html` makes one file of everything.
"""
