"""How to wire a robot, for people: a plan made from its profile, a drawing of it, a page around it.

`parts` says what each part looks like, `plan` counts the wires, `layout` says where they run,
`drawing` makes SVG of that, `page` has what is said beside it, `html` makes one file of all.
"""
