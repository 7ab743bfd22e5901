"""The verbs of `tsc`: a module for each, called by the verb's name, with a function `run`."""
