"""One program that several pupils edit at once: a tree of instructions and the changes of it.

The class's computer orders the changes (`ordering`, `journal`), each page shows its own at once
(`page`). Both apply them with the same code: the pages run it in Pyodide.
"""
