"""What the stages share: words, numbers, kits, places in text, texts in each language, whole files.

Knows no stage.
"""
