"""The commands of `tsc`, verbs and their steps: a module for each, with a function `run`."""
