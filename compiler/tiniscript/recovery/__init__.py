"""Reads what was meant by a wrong program. People are told of one that it reads wholly and surely.

A module for each step: `meanings` of words, with a lexicon for each language; `rewrites`, with the
table `rows`; `slots`, `blocks`, candidates (`search`), `explanation`.
`findings` says what people are told; `suggestions` and `usage` of what no repair reads.
"""
