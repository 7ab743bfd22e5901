"""Determines the meaning of a program with mistakes, and reports only what is certain.

Seven steps, a module each: meanings of words (`meanings`, with a lexicon for each language),
rewrites (`rewrites`, with the table `rows`), slots, blocks, candidates (`search`, of whose lines
`lines` finds the readings), explanations (`slips` says what is wrong with one instruction,
`explanation` what with a text), diagnostics (`meant`). `told` asks these and all other readers in
their order.

The laws that every row and every reader keeps, and the module that enforces each:

- A repair keeps what was written: every number with its sign and its unit, every name, command,
  comparison and branch, and no block or DEF runs more or fewer times. A repair that loses one is
  only shown, with the loss (`conserved`).
- A repair that is offered is right: no mistake begins inside it (`diagnostics/fixing.py`).
- A pattern describes an instruction wherever it stands: first, last, in one line with others, or
  in a block (`rewrites` for `^` and `$`, `writing` for the end of a line).
- Two readings that cost about the same are both shown, and none is applied (`search`).
- Of these, the one that changes no movement comes first: words that may be a note
  (`suggestions`), and an ELSE with the opposite condition of its IF, so that it has no effect
  (`bracketed`, `explain_else_question`).
- A number that nobody wrote is taken from the program's other calls (`slots`, `Names.usual`), or
  else is an example and is called one (`conserved`, `name_samples`).
- An offered text can be copied as it stands: the message says what it leaves out, and which part
  is an example (`diagnostics/rendering.py`); a deletion leaves no blank line
  (`diagnostics/fixing.py`).
- If the word is missing, its values are kept: words that take them are offered (`usage`).
- A value that is yes or no, such as `KEY_A`, is a condition wherever a comparison is, and is never
  compared with anything (`meanings`, `Names.is_yes_no`).
- A condition after an instruction, `F(2, 80) IF(KEY_A);S`, may belong to what is before it: what
  comes after becomes a block only if its end is written (`blocks`).
- What follows from a reported mistake is not reported beside it (`consequences`), and what is
  wrong in several places is reported once (`dedupe`).
- A mistake points at what its message names (`pointing`), and an invisible character has a name
  (`invisible`).
- One word never decides the meaning of a line: SI before instructions is the beginning (`setup`),
  two motors are one M (`motors`), a line of Logo is one loop (`logo`), and signs that are named
  are written (`writing`).
- What follows the comment sign of another language is a note, and nothing in it is read (`notes`).
- A condition in brackets after a word that takes none is checked before that word, and a value
  there gets a name (`bracketed`).
"""
