"""Works out what a wrong program means, and reports only what it understands fully and for certain.

Seven steps, a module each: meanings of words (`meanings`, with a lexicon for each language),
rewrites (`rewrites`, with the table `rows`), slots, blocks, candidates (`search`, of whose lines
`lines` finds the readings), explanations (`slips` says what is wrong with one instruction,
`explanation` what with a text), diagnostics (`meant`). `told` asks these and all other readers in
their order.

The laws, from which no row and no reader is exempt, and where each is kept:

- What is made keeps what was written: every number with its sign and its unit, every name,
  command, comparison and branch, and no block or DEF is done more or less often. What loses one
  is only shown, with what it loses (`conserved`).
- What is offered is right: where it stands, no mistake begins in it (`diagnostics/fixing.py`).
- A pattern speaks of an instruction, wherever that stands: first, last, in one line with others,
  or in a block (`rewrites` for `^` and `$`, `writing` for the end of a line).
- Two readings that cost about the same are both shown, and none is made (`search`).
- A number that nobody wrote is an example, and is shown as one (`conserved`, `with_sample`).
- A yes or no, as `KEY_A`, is a question wherever a comparison is, and nothing is compared with it
  (`meanings`, `Names.is_yes_no`).
- A question behind an instruction, `F(2, 80) IF(KEY_A);S`, may be of what is before it: no block
  is made of what comes after unless its end is written (`blocks`).
- What follows from a mistake that is told is not told beside it (`consequences`), and what is
  wrong at several places is told once (`dedupe`).
- A mistake points at what its message names (`pointing`), and a sign that nobody sees has a name
  (`invisible`).
- What the comment sign of another language begins is a note, and nothing in it is read (`notes`).
- A question in brackets that a word has not is asked before it, and a value there is named
  (`bracketed`).
"""
