"""Determines the meaning of a program with mistakes, and reports only what is certain.

Seven steps, a module each: meanings of words (`meanings`, with a lexicon for each language),
rewrites (`rewrites`, with the table `rows`), slots, blocks, candidates (`search`, of whose lines
`lines` finds the readings), explanations (`slips` says what is wrong with one instruction,
`explanation` what with a text), diagnostics (`meant`). `told` asks these and all other readers in
their order.

The laws, from which no row and no reader is exempt, and where each is kept:

- What is made keeps what was written: every number with its sign and its unit, every name,
  command, comparison and branch, and no block or DEF is done more or less often. A repair that
  loses one is only shown, with the loss (`conserved`).
- What is offered is right: where it stands, no mistake begins in it (`diagnostics/fixing.py`).
- A pattern speaks of an instruction, wherever that stands: first, last, in one line with others,
  or in a block (`rewrites` for `^` and `$`, `writing` for the end of a line).
- Two readings that cost about the same are both shown, and none is made (`search`).
- Of them the one that changes no movement is first: words that may be a note (`suggestions`), and
  an ELSE that asks the opposite of its IF, so that it asks nothing (`bracketed`,
  `explain_else_question`). - A number that nobody wrote is the one of the program's other calls
  (`slots`, `Names.usual`), else an example, and is said to be one (`conserved`, `name_samples`). -
  What is offered can be copied as it stands: what it leaves out, and which of it is an example, is
  said in the message (`diagnostics/rendering.py`); what is taken out leaves no blank line
  (`diagnostics/fixing.py`). - Values stay where their word is missing: words that take them are
  offered (`usage`). - A yes or no, as `KEY_A`, is a question wherever a comparison is, and nothing
  is compared with it (`meanings`, `Names.is_yes_no`). - A question behind an instruction, `F(2, 80)
  IF(KEY_A);S`, may be of what is before it: no block is made of what comes after unless its end is
  written (`blocks`). - What follows from a mistake that is told is not told beside it
  (`consequences`), and what is wrong at several places is told once (`dedupe`). - A mistake points
  at what its message names (`pointing`), and a sign that nobody sees has a name (`invisible`). - A
  word alone never says what a line says together: SI before instructions is the beginning
  (`setup`), two motors are one M (`motors`), a line of Logo is one loop (`logo`), signs that are
  named are written (`writing`). - What the comment sign of another language begins is a note, and
  nothing in it is read (`notes`). - A question in brackets that a word has not is asked before it,
  and a value there is named (`bracketed`).
"""
