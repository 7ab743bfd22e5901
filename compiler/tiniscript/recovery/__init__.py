"""Reads what was meant by a wrong program. People get the codes that were handed over to it.

Six concepts, a module each: concept tokens (`concepts`, with a lexicon for each language),
rewrites (`rewrites`, with the table `rows`), slots, blocks, candidates (`search`), explanations.
`findings` says what was handed over; all else runs in shadow.
"""
