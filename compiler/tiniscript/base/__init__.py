"""What the stages share: words, limits, numbers, kits, traces, places in text,
texts in each language, whole files.

Knows no stage.
"""
