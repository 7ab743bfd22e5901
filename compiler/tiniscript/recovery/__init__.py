"""Reads what was meant by a wrong program. In shadow: nothing that people run asks it yet.

Six concepts, a module each: concept tokens (`concepts`, with a lexicon for each language),
rewrites (`rewrites`, with the table `rows`), slots, blocks, candidates (`search`), explanations.
"""
