"""Reads what was meant by a wrong program. People are told of one that it reads wholly and surely.

Six steps, a module each: meanings of words (`meanings`, with a lexicon for each language),
rewrites (`rewrites`, with the table `rows`), slots, blocks, candidates (`search`, of whose lines
`lines` finds the readings), explanations (`slips` says what is wrong with one instruction,
`explanation` what with a text).
`told` has the steps to what people are told, and the laws that hold there, in their order:
`findings` says it of what is read; of what no repair reads `suggestion_rows` says it, a table of
what stands beside instructions (`suggestions`) and of what was found (`usage`); `consequences` and
`dedupe` what is not told beside it.
"""
