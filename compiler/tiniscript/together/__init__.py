"""Shared editing of a program by several pupils: a tree of instructions and its changes.

The class's computer orders the changes (`ordering`, `journal`), each page shows its own at once
(`page`). Both apply them with the same code: the pages run it in Pyodide.
"""
