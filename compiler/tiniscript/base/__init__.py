"""Code that all stages share: words, limits, numbers, kits, traces, places in a text,
texts in each language, writing of whole files.

Knows no stage.
"""
