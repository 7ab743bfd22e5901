r"""The rows: each slip that the recovery reads, with an example that is a test.

`TOKENS` rewrites tokens with meanings. Its columns:

    pattern | becomes | cost | code | how | example => what becomes of it

A pattern is tokens with spaces between: a word of the language or one that means it (`LOOP`), a
part of a sentence of the lexicon (`then`), a sign, or a class. `A|B` are alternatives, `'|'` is a
sign that would be one of the signs here, `?`, `*` and `+` stand after what may be missing or be
repeated. `^` is the beginning of an instruction: a line, or the text after `SI|`, a `;` or a
brace; `$` is its end. A row of a whole line says `^^` and `$$`. `c=` captures, and `<part>` is a
piece of PARTS. The cheapest reading is reported; 1 is usual.
Classes: @num @word @val (a value with a name), of which an @amount is no yes or no by itself,
@cross (X that is not a name) @like_CM
@like_DEG (a slip away) @name @newname @usedname @def, of which a @defw takes
values and a @step does not, @callw (takes values)
@device (an actuator) @start (begins an instruction) @close (ends one) @unit; a number that is
@whole, or may be a @time, a @power or an @angle; any token but separators and braces: @any, nor `:`
and `?`: @cond, nor brackets: @noparen; but braces: @all, which closes the brackets that it opens;
but braces, brackets and `<`: @nobrace.

`becomes` is tokens: `$c` what was captured, `&c` that in words of the language or in digits, and
functions: @not (the opposite question), @same (a number that is another one, too), @most and @least
(the range of an actuator), @endof (the end of a header), @dec (a decimal comma), @cat (a zero
apart), @mmss, @own (a number with its unit, in the unit that values have), @xn (`x4`), @label
(nothing, of a DEF that is called elsewhere). `how`: `first`
is made before any other is tried, `applied` may be made without asking, `offered` is only shown, as
is `first offered`. An example's lines are parted by ⏎. A row continues in indented lines.

`⟨less¦more⟩` and, in the same row, `⟨<¦>⟩` make a row of each: one with `less` and `<`, and one
with `more` and `>`. Each has its own example.

`SIGNS` rewrites characters before there are tokens: `re` patterns and their replacements, in the
same columns except for the cost. `^` and `$` are those of an instruction there, too, `\A` and `\Z`
those of a line.

Rows are sorted by subject. A row is here since programs of strangers need it, or since it keeps a
law, which the heading above it names:

- `sign`: a sign of paper, a telephone or another language means the one of this language.
- `number`: a number keeps its digits, its sign, its unit and how many times it says.
- `branch`: no question, order or branch of a line is left out of what is offered.
- `kind`: what is read of one word is read of each of its kind: comparisons, ends, blocks, devices.
- `two`: of two meanings that cost about the same both are offered.
- `other`: without it another row reads the line as something else.
- `code`: nothing else reports its code, which the list of mistakes has.
"""

from tiniscript.diagnostics import codes

# Pieces of patterns that several rows have.
PARTS = {
    "body": "b=@start r=@all*",
    "block": "h=IF|WHILE|ELSEIF|LOOP|WHEN",
    "asks": "h=IF|WHILE|ELSEIF|WHEN",
    "question": "( c=@any+ )",
    "for": "LOOP|count",
    "end": "BREAK ; ENDIF ; END_LOOP",
}

# A misplaced DEF or end.
MISPLACED_CODES = {codes.CALL_BEFORE_DEF, codes.CALLS_ITSELF, codes.DEF_NOT_TOP, codes.WRONG_END}

# Slips of one sign, tried if no row reads a line: of one that is missing, of one that is taken
# for another, of one too many, and of one after its neighbour.
CODE_OF_MISSING_SIGN = {"(": codes.MISSING_OPEN, ")": codes.MISSING_CLOSE, ",": codes.MISSING_COMMA}
MISSING_COST, CONFUSED_COST, EXTRA_COST, SWAPPED_COST = 1.6, 1.1, 1.5, 1.7
SIGNS_MEANT_BY = {
    "(": ")", ")": "(", "[": "(", "]": ")", "{": "(", "}": ")", ".": ",;", ";": ",)", ":": ",;",
    ",": ";", "'": ",", "|": ";", "!": "|",
}  # fmt: skip

# The sign on the same key as `)`, and the one next to `,`: text in the place of the sign may mean
# it.
CLOSE_KEY, COMMA_KEY = "9", "M"

# Replacements of `SI|` and `SB|`: signs, a letter that looks like the bar, or an empty text.
SETUP = (
    r"\s*(?P<head>[Ss][IiÍíBb1Ll])(?P<sep>\s*(?:\|\|+|//|[^\w\s|｜(]{1,3}\|?|[(_]|\||"
    r"(?!IF\([^)]*[<>=])[lLI1](?=\s+[^\W\d]|(?i:[FBLRWM]|IF|LOOP|WHILE|BEEP)\())?)\s*"
)
BARS = (":", "||", "/", "\\", "¦", "!", "¡")  # signs that replace the bar before any text

SIGNS = r"""
# characters that stand for others, and what is pasted around a program: sign, number, kind, other
(?<!\) )(["'«»`])([A-Za-z0-9_.,()| <>=]*[A-Za-z0-9)][A-Za-z0-9_.,()| <>=]*)(?:\1|»)
    | `\2` | TS006 | applied
    | F("2","80") => F(2,80)
(?<=\([1-9])\. (?=\d\d\s*\)) | `, ` | TS017 | applied | F(2. 80) => F(2, 80)
⟨(?<=[( ])0?0:(\d\d)(?=\))¦(?<==)\s*(\d{1,3}),(?=000\b)⟩
    | `\1` | TS008 | applied
    | ⟨W(0:30)¦X=1,000⟩ => ⟨W(30)¦X=1000⟩
(?<![^;])\s*([*/+=-]+)([A-Za-z](?:[^;]*[\w)])?)\1\s*(?![^;])
    | `\2` | TS054 | applied
    | **F(2, 80)** => F(2, 80)
(?<![^;])\s*(_+)([A-Za-z]\w*\s*\([^;]*\))\1\s*(?![^;])
    | `\2` | TS054 | applied
    | _F(2, 80)_ => F(2, 80)
^\s*\[[^\]\n]*\d:\d\d[^\]\n]*\][^:|()\n]*:\s*(?=\w)
    | `` | TS054 | applied
    | [14:32, 12/03] Leo: F(2, 80) => F(2, 80)
^\s*#\s*define\s+([A-Za-z]\w*)\s+(\d+(?:\.\d+)?)\s*$
    | `\1 = \2` | TS050 | applied
    | #define X 70⏎F(1, X) => X = 70⏎F(1, X)
⟨\(\s*(?:\(\s*\)\s*=>|function\s*\(\s*\))\s*\{¦^\s*\}\s*\)⟩
    | `⟨() {¦}⟩` | TS102 | applied
    | ⟨forever(() => {⏎S⏎}¦forever() {⏎S⏎})⟩ => LOOP(FOREVER);⏎S⏎END_LOOP
^^\s*["'«`](S?[IB]?\|?[^"'«»`]*\([^"'«»`]*)["'»`]\s*$$
    | `\1` | TS006 | applied
    | ⟨"SI|F(2,80);R(1,50)"¦“F(2,80);R(1,50)”⟩ => ⟨SI|¦⟩F(2,80);R(1,50)
\b([FBLR])\((\d)\.([1-9]0|100)\) | `\1(\2, \3)` | TS020 | offered | F(2.80) => F(2, 80)
(?<=\d)=(?=\s*\))|(?<=\()=(?=\.\d) | `0` | TS076 | offered | F(2, 8=) => F(2, 80)
(?<=[(,])(\s*)!(?=\s*[,)]) | `\g<1>1` | TS076 | offered | F(!, 80) => F(1, 80)
(?<=\()l(?=\s*,) | `1` | TS008 | offered | F(l, 80) => F(1, 80)
(?<=\d) (?=000\b) | `` | TS008 | applied | F(2, 80); SHOW(1 000) => F(2, 80); SHOW(1000)
\b([FBLR])(?:8(\d),\s*(\d\d)[9)]|9(\d),\s*(\d\d)[0)])\s*(?=;|$)
    | `\1(\2\4, \3\5)` | TS010 | offered
    | F82, 809 => F(2, 80)
\b(IF|WHILE|UNTIL)\s*¿\s*([^?()¿]+?)\s*\?
    | `\1(\2)` | TS015 | applied
    | IF ¿DISTANCE < 10?⏎S⏎ENDIF => IF(DISTANCE < 10)⏎S⏎ENDIF
\b(\w+?)\s*(?:(?:\^|\*\*)\s*2\b|²)
    | `\1 * \1` | TS010 | offered
    | X = 7^2⏎SHOW(X) => X = 7 * 7⏎SHOW(X)
\(f"[^"{}]*\{(\w+)\}[^"{}]*"\)
    | `(\1)` | TS006 | offered
    | print(f"{DISTANCE} cm") => SHOW(DISTANCE)
(?<=\d)\. (?=\d) | `.` | TS008 | applied | F(1. 5, 80) => F(1.5, 80)
\bLOOP_?(\d+)(?=\s*(?:;|$))
    | `LOOP(\1)` | TS015 | applied
    | LOOP4;F(2, 80);END_LOOP => LOOP(4);F(2, 80);END_LOOP
&⟨lt¦nbsp⟩;
    | `⟨<¦ ⟩` | ⟨TS010¦TS072⟩ | applied
    | IF(DISTANCE⟨ &lt; 10¦&nbsp;< 10⟩);S;END IF => IF(DISTANCE < 10);S;END_IF
(?<=\d) ?⟨½¦¾⟩ | `⟨.5¦.75⟩` | TS010 | applied | F(1 ⟨½¦¾⟩, 80) => F(⟨1.5¦1.75⟩, 80)
⟨×¦÷¦∞⟩
    | `⟨*¦/¦FOREVER⟩` | TS010 | applied
    | ⟨W(2×3)¦W(6÷3)¦LOOP(∞);S;END_LOOP⟩ => ⟨W(2*3)¦W(6/3)¦LOOP(FOREVER);S;END_LOOP⟩
\b([FBLRMW]|BEEP)(\([^()]*\))\s*(?:…|\.{2,3})\s*(?=[A-Za-z]+\s*\()
    | `\1\2; ` | TS010 | applied
    | F(2, 80)...R(1, 50) => F(2, 80); R(1, 50)
½ | `0.5` | TS010 | applied | W(½) => W(0.5)
(?<=\d)(?:[´"`]|\)\s*,\s*\()(?=\d+\)) | `, ` | TS076 | applied | F(2´80) => F(2, 80)
(?<=\))\s+(?:/\s*|-)(?=(?-i:[a-zñáéíóú]+)/?\s*$)
    | ` // ` | TS007 | applied
    | F(1, 80) / adelante => F(1, 80) // adelante
(?i:\bFOREVER)\.(?=\d)
    | `FOREVER, ` | TS017 | applied
    | F(FOREVER.60) UNTIL(DISTANCE < 9) => F(FOREVER, 60) UNTIL(DISTANCE < 9)
(?<=\d)\.\.(?=\d) | `, ` | TS020 | offered | X = RANDOM(1..6) => X = RANDOM(1, 6)
⟨≤¦≥¦≠¦¡=¦(?<= )><⟩
    | `⟨<=¦>=¦<>¦<>¦<>⟩` | TS010 | applied
    | IF(DISTANCE ⟨≤¦≥¦≠¦¡=¦><⟩ 10);S;ENDIF => IF(DISTANCE ⟨<=¦>=¦<>¦<>¦<>⟩ 10);S;ENDIF
[→➜⇒]|[–—]> | `;` | TS061 | applied | →F(2, 80) => ;F(2, 80)
</?[a-z]+/?>|\A\s*(?:[$>] tsc\b.*|```\w*\s*)\Z | `` | TS072 | applied | <b>F(2, 80)</b> => F(2, 80)
\A\s*tsc(?: \w+)? (?:(["'])(S[IB]\|.*)\1\Z|(?=S[IB]\|))
    | `\2` | TS044 | applied
    | tsc live "SI|F(2, 80)" => SI|F(2, 80)
⟨(?<=\w)\s+\[\s*$$¦^^\s*\]\s*$$⟩
    | `⟨ {¦}⟩` | TS047 | applied
    | REPEAT 6 [⏎F(1, 50)⏎] => LOOP(6);⏎F(1, 50)⏎END_LOOP
^\s*[•·►▶✔✓*–—-]\s+(?=[A-Za-z]) | `` | TS054 | applied | ⟨*¦•⟩ F(2,80) => F(2,80)
^\s*(?:-(?=[A-Z]\w*\()|[=-]?>+\s*) | `` | TS054 | applied | ⟨> ¦=> ¦-> ¦-⟩F(2,80) => F(2,80)
^\s*(?![⛔✋🛑])[➤↑↓⏫⏬⬅-⬇\u2600-\u27A1\U0001F300-\U0001FAFF]\uFE0F?\s*(?=[A-Za-z]+\s*\()
    | `` | TS054 | applied
    | ✅ F(2,80) => F(2,80)
(?<![\d/*])(?<![\d)] )⟨1/2¦1/4¦3/4⟩(?!\d)(?=\s*[a-z])
    | `⟨0.5¦0.25¦0.75⟩` | TS049 | applied
    | F(⟨1/2¦1/4¦3/4⟩ minuto, 80) => F(⟨30¦15¦45⟩, 80)
(?<=\d) ⟨1/2¦1/4¦3/4⟩(?=\s*[,)a-z])
    | `⟨.5¦.25¦.75⟩` | TS008 | applied
    | F(2 ⟨1/2¦1/4¦3/4⟩, 80) => F(⟨2.5¦2.25¦2.75⟩, 80)
(?:^|(?<=[|(]))[¡¿]+|[¿¡](?=\W)|\?(?=\))|(?<=\d)[|¿?!"]+(?=\s*\))
    | `` | TS005 | applied
    | F(5, 60) UNTIL(¿DISTANCE < 20?) => F(5, 60) UNTIL(DISTANCE < 20)
(?<![\w.])([1-9])[oO]⟨[oO]¦⟩\b | `\g<1>0⟨0¦⟩` | TS008 | applied | F(2,⟨1OO¦8O⟩) => F(2,⟨100¦80⟩)
\b[oO]\.(\d+) | `0.\1` | TS008 | applied | F(O.5, 60) => F(0.5, 60)
(?<=\d)\.(?=\s*[,);]) | `` | TS008 | offered | F(2, 80.) => F(2, 80)
(?<=\d)(?:'(?=\d+\s*(?:[,;]|$))|(?<!\d\d),(?=\d+\s*(?:s|segs?|segundos?|sec|seconds?|minutos?)\b))
    | `.` | TS012 | applied
    | F(1'5, 80) => F(1.5, 80)
(?<=[\w)])(?:\s*(?:(?![⛔✋🔼🔽🛑])[¡¿!…?$¬^´`¨\\\u2600-\u2793\U0001F300-\U0001FAFF]+|<br>)|\.{2,})\s*$
    | `` | TS005 | applied
    | STOP! => STOP
(?:(?<=\|)|(?<=;)|^)(\s*)([FBLR])(?!\s+-\d|\s+\.\d|\.\d+(?![\d.]))\s*[_.<=,;"
    -]?\s*([12]?\d(?:\.\d+)?)(?:[_,;<=-]+ ?| +|[ .]+(?=[1-9]0\b|100\b))(?:=
    ?)?(\d+)\s*[])>"]?\s*(?=;|$)
    | `\1\2(\3, \4)` | TS015 | applied
    | F2,80 => F(2, 80)
(?:^|(?<=[;|]))(\s*)M(-?\d+)[\s,;]+(-?\d+)\s*\)?\s*(?=;|$)
    | `\1M(\2, \3)` | TS015 | applied
    | M50 -50 => M(50, -50)
(?<=\d)(?:\)\((?=\d)|['·_=&<]\s*(?=\d+\))) | `,` | TS076 | applied | F(3)(70) => F(3,70)
([<>=]\s*\d+)\.\s+(?=[A-Za-z]\w*\s*\()
    | `\1; ` | TS010 | applied
    | F(5, 60) UNTIL DISTANCE<10. S() => F(5, 60) UNTIL(DISTANCE<10); S
(?<=\w)\.(?=\() | `` | TS005 | applied | F.(2, 80) => F(2, 80)
⟨(?<=[\w)])\s*\.\s*$¦(?<=\))\s*\.\s+(?=\w)⟩
    | `;⟨¦ ⟩` | TS010 | applied
    | ⟨S.¦F(2,80). R(1,60). S.⟩ => ⟨S;¦F(2,80); R(1,60); S;⟩
^\s*/\s*(?=(?-i:[a-z]+)(?! ?\())
    | `// ` | TS007 | applied
    | SI|F(2, 60)⏎/ gira⏎R(1, 50) => SI|F(2, 60)⏎// gira⏎R(1, 50)
\b(?:basic\.)?forever\s*\(\s*(?:function\s*\(\s*\)|\(\s*\)\s*=>)\s*\{
    | `basic.forever() {` | TS102 | applied
    | basic.forever(function () {⏎S⏎}) => LOOP(FOREVER);⏎S⏎END_LOOP
^input\.onButtonPressed\(\s*Button\.([AB])\s*,\s*(?:function\s*\(\s*\)|\(\s*\)\s*=>)\s*\{
    | `WHEN(KEY_\1) {` | TS102 | applied
    | input.onButtonPressed(Button.A, function () {⏎S⏎}) => WHEN(KEY_A);⏎S⏎END_WHEN
^\s*\}\s*\)\s*;?\s*$ | `}` | TS047 | applied | forever(() => {⏎S⏎}) => LOOP(FOREVER);⏎S⏎END_LOOP
\b([A-Za-z]+)\.read\(\)
    | `\1` | TS102 | applied
    | IF(DISTANCE.read()<10);S;ENDIF => IF(DISTANCE<10);S;ENDIF
\b(?:time|robot|console|serial|self|car|motor|System\.out|random|math)\.(?=[A-Za-z]+\s*\()
    | `` | TS102 | applied
    | time.sleep(0.5) => W(0.5)
\b(END|FIN)(?: _|[. -](?=(?:LOOP|IF|WHILE|DEF|TASK|WHEN)\b))
    | `END_` | TS022 | applied
    | IF(DISTANCE < 10);S;END IF => IF(DISTANCE < 10);S;END_IF
"""

TOKENS = r"""
# signs that other languages have: sign
a=@num|@val|) ⟨@cross¦·¦X⟩ b=@num|@val|(
    | $a * $b | ⟨1¦1¦1.2⟩ | TS010 | ⟨applied¦applied¦offered⟩
    | ⟨SHOW(DISTANCE X 2)¦SHOW(2 · 3)¦X = 4⏎W(2 x X)⟩ => ⟨SHOW(DISTANCE * 2)¦SHOW(2 * 3)¦X = 4⏎W(2 *
    X)⟩
^ v=⟨@usedname¦@name⟩ == e=@any+ $
    | $v = $e | ⟨0¦1⟩ | ⟨TS010¦TS050⟩ | ⟨first¦first offered⟩
    | X == 5⟨⏎F(X, 80)¦⟩ => X = 5⟨⏎F(X, 80)¦⟩
⟨==¦!=|=!¦=>¦=<¦< or? =¦> or? =¦!|no <¦!|no >⟩
    | ⟨=¦<>¦>=¦<=¦<=¦>=¦>=¦<=⟩ | 0 | TS010 | first
    | IF(DISTANCE ⟨==¦!=¦=>¦=<¦< =¦> =¦!<¦!>⟩ 10);S;ENDIF => IF(DISTANCE ⟨=¦<>¦>=¦<=¦<=¦>=¦>=¦<=⟩
    10);S;ENDIF
⟨&&¦:=⟩
    | ⟨AND¦=⟩ | 0 | ⟨TS010¦TS050⟩ | first
    | ⟨SI|IF(DISTANCE<10 && LIGHT_L>50);S;ENDIF¦v := 50⏎F(2, v)⟩ => ⟨SI|IF(DISTANCE<10 AND
    LIGHT_L>50);S;ENDIF¦v = 50⏎F(2, v)⟩
] | ) | 1 | TS010 | applied | F(2, 80] => F(2, 80)
v=@val [ n=@num )
    | $v < $n ) | 1 | TS010 | offered
    | IF(DISTANCE[30)⏎S⏎ENDIF => IF(DISTANCE < 30)⏎S⏎ENDIF
o=(|AND|OR !|no v=@measured e=)|AND|OR
    | $o $v = 0 $e | .5 | TS010 | first offered
    | IF(!LIGHT_L);S;ENDIF => IF(LIGHT_L = 0);S;ENDIF
! v=@val|( | NOT $v | 1 | TS010 | first | X = TRUE⏎IF(!X);S;ENDIF => X = TRUE⏎IF(NOT X);S;ENDIF
# sums in words: kind
o==|(|, a=@num|@val minus b=@num|@val
    | $o $a - $b | 1 | TS010 | first
    | SHOW(8 minus 4) => SHOW(8 - 4)
# comparisons in words, a row for each sense, and a sign: kind
is? ⟨less than?¦more⟩ or? equal to|than?
    | ⟨<=¦>=⟩ | 1 | TS010 | first
    | IF(DISTANCE es ⟨menor¦mayor⟩ o igual que 10);S;ENDIF => IF(DISTANCE ⟨<=¦>=⟩ 10);S;ENDIF
is? ⟨one? less than?¦one? more than?¦extra than⟩
    | ⟨<¦>¦>⟩ | 1 | TS010 | first
    | IF(DISTANCE ⟨menor¦mayor¦es mas de⟩ 10);S;ENDIF => IF(DISTANCE ⟨<¦>¦>⟩ 10);S;ENDIF
o=(|AND|OR l=@val is NOT|no equal* to|than? n=@num|@val
    | $o $l <> $n | 1 | TS010 | applied
    | IF(DISTANCE is not 10);S;ENDIF => IF(DISTANCE <> 10);S;ENDIF
o=(|AND|OR|NOT l=@val is|equal+ to|than? n=@num|@val
    | $o $l = $n | 1 | TS010 | applied
    | IF(DISTANCE es igual a 10);S;ENDIF => IF(DISTANCE = 10);S;ENDIF
⟨is? different than?¦no is|equal to|equal? one?⟩
    | <> | 1 | TS010 | first
    | IF(DISTANCE ⟨distinto de¦NO ES⟩ 10);S;ENDIF => IF(DISTANCE <> 10);S;ENDIF
l=@val is? between a=@num and b=@num
    | $l > $a AND $l < $b | 1 | TS037 | offered
    | IF(DISTANCE entre 5 y 10);S;ENDIF => IF(DISTANCE > 5 AND DISTANCE < 10);S;ENDIF
# questions and sums: kind, branch
a=@num|@val s=<|<=|>|>= b=@val t=<|<=|>|>= c=@num|@val
    | $a $s $b AND $b $t $c | 1 | TS037 | applied
    | SI|IF(10>DISTANCE>5);S;ENDIF => SI|IF(10>DISTANCE AND DISTANCE>5);S;ENDIF
o==|(|,|+|-|*|<|> average ( a=@num|@val , b=@num|@val )
    | $o ( $a + $b ) / 2 | 1 | TS010 | offered
    | SHOW(AVERAGE(LIGHT_L, LIGHT_R)) => SHOW((LIGHT_L + LIGHT_R) / 2)
a=@num|@val ⟨modulo¦plus⟩ b=@num|@val
    | $a ⟨%¦+⟩ $b | 1 | TS010 | first
    | X = 7⏎X = X ⟨MOD¦mas⟩ 2 => X = 7⏎X = X ⟨%¦+⟩ 2
no l=@val|(
    | NOT $l | 1 | TS010 | applied
    | IF(NO⟨ DISTANCE < 10¦(DISTANCE < 10)⟩)⏎F(1,50)⏎ENDIF => IF(NOT⟨ DISTANCE < 10¦(DISTANCE <
    10)⟩)⏎F(1,50)⏎ENDIF
l=@val s=<|>|<=|>= a=@num o=AND|OR t=<|>|<=|>= b=@num
    | $l $s $a &o $l $t $b | 1 | TS018 | offered
    | IF(DISTANCE < 10 OR < 5);S;ENDIF => IF(DISTANCE < 10 OR DISTANCE < 5);S;ENDIF
^ c=@cond+ ? <body> : d=@start s=@all* $
    | IF ( $c ) ; $b $r ; ELSE ; $d $s ; ENDIF | 1 | TS042 | offered
    | DISTANCE < 10 ? S : F(1, 60) => IF(DISTANCE < 10);S;ELSE;F(1, 60);ENDIF
^ c=@cond+ ? b=@start r=@all* $
    | IF ( $c ) ; $b $r ; ENDIF | 1 | TS042 | offered
    | DISTANCE < 10 ? S => IF(DISTANCE < 10);S;ENDIF
h=WHILE ( 1 )
    | &h ( TRUE ) | 1 | TS010 | first
    | ENQUANTO(1) { F(1, 50) } => WHILE(TRUE);F(1, 50);END_WHILE;
o==|( a=@num|@val over by|over? b=@num|@val
    | $o $a / $b | 1 | TS010 | applied
    | SHOW(10 entre 2) => SHOW(10 / 2)
h=IF|WHILE|UNTIL|WHEN|ELSEIF ( a=@amount ⟨then|&¦or|OR⟩ b=@val s=<|> n=@num )
    | &h ( $a $s $n ⟨AND¦OR⟩ $b $s $n ) | 1 | TS010 | first offered
    | IF(LIGHT_L ⟨y¦o⟩ LIGHT_R > 500)⏎S⏎ENDIF => IF(LIGHT_L > 500 ⟨AND¦OR⟩ LIGHT_R > 500)⏎S⏎ENDIF
a=@num|@val ⟨then|&¦or⟩ b=@val|less|more|NOT⟨|<¦⟩
    | $a ⟨AND¦OR⟩ $b | 1 | TS010 | first
    | IF(DISTANCE < 10 ⟨y¦o⟩ LIGHT_L > 100);S;ENDIF => IF(DISTANCE < 10 ⟨AND¦OR⟩ LIGHT_L >
    100);S;ENDIF
a=@num|@val '|' b=@val
    | $a OR $b | 1 | TS010 | applied
    | IF(DISTANCE<10 | LIGHT_R>50)⏎S⏎ENDIF => IF(DISTANCE<10 OR LIGHT_R>50)⏎S⏎ENDIF
# numbers, units, values: number
a=@num b=0 | @cat:a:b | 1 | TS008 | offered | F(2, 8 0) => F(2, 80)
a=@num c=, b=@num | @dec:a:c:b | 1 | TS012 | applied | W(2,5) => W(2.5)
o=(|,|; a=@num % ) | $o $a ) | 1 | TS049 | first | F(2,80%) => F(2,80)
o=+|-|=|, a=@num % ⟨e=;|,¦$⟩
    | $o $a ⟨$e¦⟩ | 1 | TS049 | applied
    | X = 50⏎X = X + 10%⟨;¦⏎⟩F(2, X) => X = 50⏎X = X + 10⟨;¦⏎⟩F(2, X)
a=@num by @hundred | $a % | 1 | TS049 | first | R(1, 50 por ciento) => R(1, 50)
a=@num : b=@num | @mmss:a:b | 1 | TS008 | applied | W(1:30) => W(90)
⟨s=<|>|<=|>=|=|<> n=@num u=M|MIN|S e=)¦^ s=@name = n=@num u=M|MIN $⟩
    | $s ⟨¦=⟩ @own:n:u ⟨$e¦⟩ | 1 | TS049 | applied
    | ⟨IF(DISTANCE < 1 m);S;ENDIF¦D = 1 m⟩ => ⟨IF(DISTANCE < 100);S;ENDIF¦D = 100⟩
s=<|>|<=|>=|=|<> n=@num u=@unit
    | $s @own:n:u | 1 | TS049 | first
    | ⟨x = 5 cm¦T = 500 ms⏎W(T)⟩ => ⟨x = 5¦T = 0.5⏎W(T)⟩
v=@val CM|in? CM | $v | 2 | TS049 | applied | SHOW DISTANCE cm => SHOW(DISTANCE)
v=@val seconds|@unit e=,|) | $v $e | 1 | TS049 | applied | SHOW(distancia cm) => SHOW(DISTANCE)
the v=@val | $v | 1 | TS102 | first | lee la distancia => DISTANCE
o=(|AND|OR the? wall s=<|<=|>|>= n=@num CM?
    | $o DISTANCE $s $n | 1 | TS102 | offered
    | F(5, 60) HASTA(PARED < 10 CM) => F(5, 60) UNTIL(DISTANCE < 10)
# variables: kind, other, code
v=@name = a=@num|@val b=@start
    | $v = $a ; $b | 1 | TS013 | applied
    | X = DISTANCE F(1, 50) => X = DISTANCE;F(1, 50)
v=@name ⟨++¦--⟩ | $v = $v ⟨+¦-⟩ 1 | 1 | TS050 | applied | v = 0⏎v⟨++¦--⟩ => v = 0⏎v = v ⟨+ ¦-⟩1
^ v=@name <- e=@any+ $ | $v = $e | 1 | TS050 | applied | X <- 5⏎F(X, 80) => X = 5⏎F(X, 80)
^ v=@name = + e=@num $ | $v = $v + $e | 1 | TS050 | offered | X = 1⏎X = +1 => X = 1⏎X = X + 1
v=@name += e=@any+ | $v = $v + $e | 1 | TS050 | applied | X = 1⏎X += 2 => X = 1⏎X = X + 2
^ v=@name = w=@name = e=@any+ $ | $v = $e ; $w = $e | 1 | TS137 | offered | X = X = 5 => X = 5;X = 5
^ v=@name , w=@name = e=@num , f=@num $
    | $v = $e ; $w = $f | 1 | TS050 | applied
    | X, Y = 5, 6⏎F(X, Y) => X = 5;Y = 6⏎F(X, Y)
^ n=@newname = b=@callw|LOOP r=@any+ $
    | DEF $n ; $b $r | 2 | TS051 | applied
    | BAILE = L(1,60)⏎BAILE => DEF BAILE;L(1, 60);END_DEF⏎BAILE
^ declare ⟨v=@newname ;? $¦declare? v=@name =⟩
    | $v = ⟨0¦⟩ | 1 | TS044 | ⟨offered¦applied⟩
    | var vel⟨¦ = 50⟩⏎F(2, vel) => vel = ⟨0¦50⟩⏎F(2, vel)
^ ⟨set|declare the? v=@word =|to|is?¦v=@newname is|equal|: to|equal? one?⟩ e=@num $
    | $v = $e | ⟨1¦2⟩ | TS050 | applied
    | ⟨set x to 5¦velocidad es 60⏎F(2, velocidad)⟩ => ⟨x = 5¦velocidad = 60⏎F(2, velocidad)⟩
a=@num|@close b=@name = | $a ; $b = | 1.5 | TS013 | applied | F(1, 50) X = 2 => F(1, 50);X = 2
^ v=@usedname e=@num f=;|$ | $v = $e $f | 3 | TS050 | applied | X 17⏎SHOW(X) => X = 17⏎SHOW(X)
^ ⟨add¦subtract⟩ n=@num|@val from|to the? v=@name $
    | $v = $v ⟨+¦-⟩ $n | 1 | TS050 | offered
    | X = 40⏎⟨suma¦resta⟩ 5 a X⏎F(1, X) => X = 40⏎X = X ⟨+¦-⟩ 5⏎F(1, X)
^ ⟨add¦subtract⟩ to|from the? v=@name n=@num $
    | $v = $v ⟨+¦-⟩ $n | 1 | TS050 | offered
    | X = 40⏎⟨sumar a¦restar a⟩ X 5⏎F(1, X) => X = 40⏎X = X ⟨+¦-⟩ 5⏎F(1, X)
^ give to the? v=@name the? sensing? e=@num $
    | $v = $e | 1 | TS050 | offered
    | dar a X el valor 5⏎F(X, 80) => X = 5⏎F(X, 80)
^ ⟨multiply¦divide¦increase¦decrease⟩ the? v=@name by|over s='-'? n=@num|@val $
    | $v = $v ⟨*¦/¦+¦-⟩ $s $n | 1 | TS050 | offered
    | X = 40⏎⟨multiply¦divide¦increase¦decrease⟩ X by 2 => X = 40⏎X = X ⟨*¦/¦+¦-⟩ 2
^ keep the? e=@val|@num to v=@word $
    | $v = $e | 1.5 | TS050 | applied
    | guardar 80 en potencia⏎F(2, potencia) => potencia = 80⏎F(2, potencia)
# calls and their brackets: kind, two, other
^ TIME ( n=@num ) $ | W ( $n ) | 1 | TS102 | offered | TIME(2);F(1, 50) => W(2);F(1, 50)
a=@num b=@val
    | $a * $b | 1.5 | TS048 | offered
    | V = 30⏎F(1, 2V) => V = 30⏎F(1, 2 * V)
f=MAX|MIN ( a=@noparen+ , b=@noparen+ , c=@noparen+ )
    | $f ( $f ( $a , $b ) , $c ) | 1 | TS020 | offered
    | X = MAX(LIGHT_L, LIGHT_R, 200)⏎F(1, X) => X = MAX(MAX(LIGHT_L, LIGHT_R), 200)⏎F(1, X)
o==|(|, f=⟨ABS a=@num|@val¦MAX|MIN|ROUND|RANDOM a=@num|@val , b=@num|@val⟩ e=;|$
    | $o $f ( $a ⟨¦, $b⟩ ) $e | 1 | TS015 | offered
    | X = ⟨ABS DISTANCE¦ROUND DISTANCE, 1⟩⏎F(X, 50) =>
    X = ⟨ABS(DISTANCE)¦ROUND(DISTANCE, 1)⟩⏎F(X, 50)
x=@callw [ | $x ( | 1 | TS010 | first | F[2,80] => F(2,80)
x=@callw '{' c=@nobrace+ '}' | $x ( $c ) | 1 | TS015 | applied | SI|F{2,80} => SI|F(2,80)
RANDOM ( between|from? a=@num to|and|until|- b=@num )
    | RANDOM ( $a , $b ) | 1 | TS017 | applied
    | X = RANDOM(1 al 3)⏎F(X, 50) => X = RANDOM(1, 3)⏎F(X, 50)
c=⟨@callw¦RANDOM|ROUND|MIN|MAX⟩ ( a=@noparen+ ; b=@noparen+ e=)|$
    | $c ( $a , $b ) | 1 | TS019 | applied
    | ⟨F(2;80¦X = RANDOM(1; 6)⟩ => ⟨F(2, 80)¦X = RANDOM(1, 6)⟩
a=@callw b=@num ,? c=@num ,|;|and? d=@callw
    | $a ( $b , $c ) ; $d | 1.5 | TS015 | applied
    | F 2,80,R 1,50 => F(2, 80);R(1, 50)
v=@val|@def|S|STOP|BREAK|START|ELSE|ENDIF|END_LOOP ( )
    | $v | 1 | TS028 | first
    | LIGHT_L() => LIGHT_L
^ c=@callw :? a='-'? b=@num ; d='-'? e=@num )|]|$
    | $c ( $a $b , $d $e ) | 1 | TS015 | applied
    | R 0.5; 60 => R(0.5, 60)
SHOW ( TIME ) | SHOW ( TIME ) | 1 | TS102 | applied | mostrar(tiempo) => SHOW(TIME)
c=@callw ( a=@noparen+ s=*|/|%|- b=@num|@val t=+|-|*|/|% d=@noparen+ ) ) e=;|$
    | $c ( $a $s ( $b $t $d ) ) $e | 1 | TS041 | applied
    | SHOW(5 / 3 - 3)) => SHOW(5 /(3 - 3))
c=@callw ( a=@noparen+ ) ) e=;|$ | $c ( $a ) $e | 1 | TS041 | applied | F(2, 80)) => F(2, 80)
c=@callw ( a=@num ⟨/|-¦_|.|;|&|<|'|'|and|>⟩ b=@num )
    | $c ( $a , $b ) | ⟨2¦1⟩ | TS076 | ⟨offered¦applied⟩
    | F(2⟨/¦|⟩80) => F(2, 80)
SHOW ( a=@val ⟨,¦&|+|, " " &|+|,⟩ b=@val )
    | SHOW ( $a ) ; SHOW ( $b ) | ⟨2¦1⟩ | TS020 | offered
    | SHOW(DISTANCE⟨,¦ & " " &⟩ LIGHT_L) => SHOW(DISTANCE);SHOW(LIGHT_L)
^ SHOW a=@val|@num s=+|-|*|/|% b=@val|@num $
    | SHOW ( $a $s $b ) | 1 | TS015 | applied
    | SHOW LIGHT_L + LIGHT_R => SHOW(LIGHT_L + LIGHT_R)
^ SHOW a=@val ,? b=@val $
    | SHOW ( $a ) ; SHOW ( $b ) | 2 | TS015 | applied
    | SHOW DISTANCE LIGHT_R => SHOW(DISTANCE);SHOW(LIGHT_R)
c=⟨@callw¦IF|WHILE|ELSEIF|UNTIL|LOOP⟩ ( a=@noparen* b=@num|@word e=;|$⟨|UNTIL|@start¦⟩
    | $c ( $a $b ) $e | 1 | TS016 | applied
    | F(2,80⟨¦) UNTIL(DISTANCE<10⟩ => F(2,80)⟨¦ UNTIL(DISTANCE<10)⟩
⟨TONE|@of_pitch (¦TONE ( @num ,⟩ a=@num , b=@num )
    | BEEP ( @ms:b , $a ) | 1 | TS102 | offered
    | tone(⟨¦8, ⟩440, 1000) => BEEP(1, 440)
a=F|B|L|R ( ⟨u=CM|DEG (? n=@num )? , p=@num¦n=@num , p=@power u=CM|DEG¦p=@power , n=@num u=CM|DEG⟩ )
    | $a ( $n $u , $p ) | ⟨1¦1¦.9⟩ | TS076 | offered
    | ⟨B(CM(20), 60)¦F(150, 60 CM)¦R(60, 20 DEG)⟩ => ⟨B(20 CM, 60)¦F(150 CM, 60)¦R(20 DEG, 60)⟩
a=F|B|L|R ( p=@num , n=@num u=CM|DEG )
    | $a ( $n $u , $p ) | 1.1 | TS076 | offered
    | R(8, 150 DEG) => R(150 DEG, 8)
a=⟨F|B¦L|R⟩ ( n=@noparen+ @like_⟨CM¦DEG⟩ e=,|;
    | $a ( $n ⟨CM¦DEG⟩ $e | 1 | TS102 | offered
    | ⟨F(20 MC, 60)¦L(90 DG, 60)⟩ => ⟨F(20 CM, 60)¦L(90 DEG, 60)⟩
^ BEEP BEEP e=;|$
    | BEEP ( 0.2 , 440 ) ; W ( 0.2 ) ; BEEP ( 0.2 , 440 ) $e | 1 | TS102 | offered
    | bip bip => BEEP(0.2, 440);W(0.2);BEEP(0.2, 440)
@newname . c=F|B|L|R|W|BEEP ( | $c ( | 1 | TS102 | applied | bot.F(2, 80) => F(2, 80)
# UNTIL: branch, two
a=F|B|L|R|W ( b=@noparen+ ) then? S|STOP WHEN c=@cond+ $
    | $a ( $b ) UNTIL ( $c ) | .9 | TS102 | applied
    | F(10, 60) STOP WHEN DISTANCE < 12 => F(10, 60) UNTIL(DISTANCE < 12)
^ a=S|STOP UNTIL that? ( c=@any+ ) e=;|$
    | $a ; W ( FOREVER ) UNTIL ( $c ) $e | 1 | TS030 | offered
    | S HASTA(DISTANCE > 20) => S;W(FOREVER) UNTIL(DISTANCE > 20)
a=@close ⟨'|'|,|.|; UNTIL¦UNTIL that?⟩ (
    | $a UNTIL ( | 1 | ⟨TS029¦TS102⟩ | applied
    | F(2,80)⟨.UNTIL¦ HASTA⟩(DISTANCE<10) => F(2,80) UNTIL(DISTANCE<10)
^ W ( c=@val s=<|<=|>|>=|= d=@num|@val ) $
    | W ( FOREVER ) UNTIL ( $c $s $d ) | 1 | TS029 | offered
    | ESPERA(DISTANCE < 10) => W(FOREVER) UNTIL(DISTANCE < 10)
^ W ⟨UNTIL that? c=@cond+¦( UNTIL (? c=@noparen+ )? )⟩ $
    | W ( FOREVER ) UNTIL ( $c ) | 1 | ⟨TS102¦TS029⟩ | ⟨applied¦offered⟩
    | ⟨WAIT UNTIL DISTANCE < 10¦W(UNTIL DISTANCE < 10)⟩ => W(FOREVER) UNTIL(DISTANCE < 10)
a=@close UNTIL that? ⟨c=@cond+ then+ ,? b=@start¦c=@noparen+ $⟩
    | $a UNTIL ( $c ) ⟨; $b¦⟩ | 1 | TS015 | applied
    | F(2, 80) hasta DISTANCE < 10⟨ luego S¦⟩ => F(2, 80) UNTIL(DISTANCE < 10)⟨;S¦⟩
^^ ⟨UNTIL <question> ':'|'{'?¦LOOP ( FOREVER ) UNTIL <question>⟩ $
    | WHILE ( @not:c ) | ⟨3¦1⟩ | ⟨TS029¦TS102⟩ | offered
    | ⟨¦LOOP(FOREVER) ⟩UNTIL(DISTANCE < 10)⏎F(1, 60)⏎END_⟨WHILE¦LOOP⟩ => WHILE(DISTANCE >= 10)⏎F(1,
    60)⏎END_WHILE
^ ⟨a=F|B|L|R ( UNTIL (? c=@cond+ )? , b=@num¦UNTIL (? c=@cond+ )? a=F|B|L|R|W ( b=@noparen+⟩ ) $
    | $a ( ⟨FOREVER ,¦⟩ $b ) UNTIL ( $c ) | 2 | TS029 | offered
    | ⟨F(UNTIL(DISTANCE < 10),¦UNTIL DISTANCE < 10 F(2,⟩ 60) => F(⟨FOREVER¦2⟩, 60) UNTIL(DISTANCE <
    10)
# IF and WHILE: branch, kind, other
ELSE a=@val s=<|<=|>|>= b=@num|@val do|:? $
    | ELSEIF ( $a $s $b ) | .9 | TS015 | offered
    | IF(DISTANCE < 10)⏎S⏎ELSE DISTANCE < 30⏎B(1, 50)⏎ENDIF =>
    IF(DISTANCE < 10)⏎S⏎ELSEIF(DISTANCE < 30)⏎B(1, 50)⏎ENDIF
ELSE ( a=@noparen* s=<|<=|>|>=|=|<> b=@noparen+ )
    | ELSEIF ( $a $s $b ) | 1 | TS039 | offered
    | IF(DISTANCE < 10)⏎S⏎ELSE(DISTANCE < 30)⏎B(1, 50)⏎ENDIF => IF(DISTANCE < 10)⏎S⏎ELSEIF(DISTANCE
    < 30)⏎B(1, 50)⏎ENDIF
h=IF|WHILE|ELSEIF|WHEN < a=@val s=<|<=|>|>=|= b=@num|@val > do|:?
    | &h ( $a $s $b ) | 1 | TS010 | applied
    | si <DISTANCE < 15> entonces⏎S⏎fin => IF(DISTANCE < 15)⏎S⏎ENDIF
h=IF|WHILE|ELSEIF|WHEN|UNTIL ( c=@any+ ) ⟨and¦or⟩ ( d=@any+ )
    | &h ( ( $c ) ⟨AND¦OR⟩ ( $d ) ) | 1 | TS015 | applied
    | IF(DISTANCE > 5) ⟨y¦o⟩ (LIGHT_R > 9);S;ENDIF => IF((DISTANCE > 5) ⟨AND¦OR⟩(LIGHT_R >
    9));S;ENDIF
h=IF|WHILE|LOOP|UNTIL|ELSEIF :|.|->|, (
    | &h ( | 1 | TS015 | applied
    | IF:(DISTANCE < 10)⏎S⏎ENDIF => IF(DISTANCE < 10)⏎S⏎ENDIF
^ unless ⟨<question>¦that? c=@noparen+ :|,|;¦that? c=@noparen+ b=@start⟩
    | IF ( @not:c ) ; ⟨¦¦$b⟩ | ⟨1¦1.2¦1.2⟩ | TS102 | applied
    | unless⟨(distance < 10)⏎¦ distance < 10:⏎¦ distance < 10 ⟩F(1,50)⟨⏎end¦⏎ENDIF¦⟩ => IF(DISTANCE
    >= 10)⟨⏎F(1,50)⏎¦⏎F(1,50)⏎¦;F(1, 50);⟩ENDIF
h=IF|WHILE|ELSEIF|LOOP|UNTIL '{' c=@any+ '}'
    | &h ( $c ) | 1 | TS015 | applied
    | IF{DISTANCE < 10}⏎S⏎ENDIF => IF(DISTANCE < 10)⏎S⏎ENDIF
<asks> ( c=@noparen+ b=@start
    | &h ( $c ) ; $b | 1 | TS016 | offered
    | si DISTANCE < 10 S si DISTANCE > 10 F(1,50) => IF(DISTANCE < 10);S;IF(DISTANCE > 10);F(1,
    50);ENDIF;ENDIF
<asks> c=@cond+ ⟨'{'¦do|:|,|'|'|;|$⟩
    | &h ( $c ) ; ⟨{¦⟩ | 1.3 | TS015 | applied
    | SI DISTANCE < 10⟨ {⏎S⏎}¦ | S⟩ => IF(DISTANCE < 10);⟨⏎S⏎END¦S;END⟩IF
<asks> c=@cond+ b=@start
    | &h ( $c ) ; $b | 2 | TS014 | applied
    | IF DISTANCE < 10 STOP => IF(DISTANCE < 10);STOP;ENDIF
h=IF|WHILE|LOOP|WHEN ( c=@any+ ⟨,¦;⟩ <body> ) $
    | &h ( $c ) ; $b $r ; @endof:h | 1 | TS080 | applied
    | SI|IF(DISTANCE < 10⟨,¦;⟩ S) => SI|IF(DISTANCE < 10);S;ENDIF
^ '='? IF ( c=@any+ ⟨,¦;⟩ <body> ⟨,¦;⟩ d=@start s=@all* ) $
    | IF ( $c ) ; $b $r ; ELSE ; $d $s ; ENDIF | ⟨.9¦.8⟩ | TS080 | offered
    | ⟨IF(DISTANCE < 10, B(1, 60), ¦=SI(DISTANCE<10;B(1;60);⟩F(1, 60)) => IF(DISTANCE < 10);B(1,
    60);ELSE;F(1, 60);ENDIF
<block> <question> ⟨do|times¦:|,|=|?|'|'|-⟩ ':'?
    | &h ( $c ) ; | 1 | ⟨TS044¦TS014⟩ | applied
    | LOOP(3)⟨ TIMES¦:⟩⏎F(1,50)⏎END_LOOP => LOOP(3)⏎F(1,50)⏎END_LOOP
<block> <question> b=@start|'{'
    | &h ( $c ) ; $b | 1 | TS014 | applied
    | LOOP(3) F(1,50) => LOOP(3);F(1, 50);END_LOOP
<block> <question> ⟨;? (¦[⟩ <body> ⟨)¦]⟩ $
    | &h ( $c ) ; $b $r ; @endof:h | 1 | TS080 | applied
    | LOOP(4) ⟨(¦[⟩F(1,60); R(1,50)⟨)¦]⟩ => LOOP(4);F(1, 60);R(1, 50);END_LOOP
# ELSE and ELSEIF: branch
h=IF|ELSEIF <question> ( <body> ) e=ELSEIF|ELSE
    | &h ( $c ) ; $b $r ; $e | .9 | TS080 | applied
    | IF(DISTANCE < 10)(S)ELSE(F(1,50)) => IF(DISTANCE < 10);S;ELSE;F(1, 50);ENDIF
ELSE IF
    | ELSEIF | 1 | TS022 | first
    | IF(DISTANCE < 5);S;ELSE IF(DISTANCE < 9);F(1, 50);ENDIF => IF(DISTANCE < 5);S; ELSEIF(DISTANCE
    < 9);F(1, 50);ENDIF
IF <question> ? a=@any+ : b=@any+ $
    | IF ( $c ) ; $a ; ELSE ; $b ; ENDIF | 1 | TS014 | applied
    | IF(DISTANCE < 10) ? S : F(1,50) => IF(DISTANCE < 10);S;ELSE;F(1, 50);ENDIF
ELSE ( <body> ) $
    | ELSE ; $b $r | 1 | TS014 | applied
    | IF(DISTANCE < 10)(S)ELSE(F(1,50)) => IF(DISTANCE < 10);S;ELSE;F(1, 50);ENDIF
h=ELSE|TASK ⟨:|,|-|do|=|'|'¦b=@start|'{'⟩
    | &h ; ⟨¦$b⟩ | 1 | TS014 | applied
    | IF(DISTANCE<10);R(1,60);ELSE⟨:¦⟩ F(1,80);ENDIF => IF(DISTANCE < 10);R(1, 60);ELSE;F(1,
    80);ENDIF
⟨a=@any|@close h=ELSE|ELSEIF|ENDIF|END_LOOP|END_WHILE|END_DEF|END_WHEN|END_TASK¦a=@close h=end $⟩
    | $a ; &h | 1 | TS013 | applied
    | LOOP(3); F(2,80) ⟨END_LOOP¦fin⟩ => LOOP(3);F(2, 80);END_LOOP
# LOOP: number, kind, code
^ ⟨LOOP FOREVER :|,?¦FOREVER :|;?⟩ b=@start|'{'
    | LOOP ( FOREVER ) ; $b | 1 | ⟨TS015¦TS032⟩ | applied
    | ⟨LOOP FOREVER¦forever:⟩ F(1,50) => LOOP(FOREVER);F(1, 50);END_LOOP
^ LOOP n=@num times? ( <body> ) $
    | LOOP ( $n ) ; $b $r ; END_LOOP | 1 | TS080 | applied
    | repite 4 (F(1, 60) R(0.5, 60)) => LOOP(4);F(1, 60);R(0.5, 60);END_LOOP
basic . W ( n=@num )
    | W ( @ms:n ) | 1 | TS102 | applied
    | basic.pause(500) => W(0.5)
basic . FOREVER ( ) '{'
    | LOOP ( FOREVER ) ; { | 1 | TS102 | applied
    | basic.forever() {⏎S⏎} => LOOP(FOREVER);⏎S⏎END_LOOP
^ FOREVER ( ) '{'
    | LOOP ( FOREVER ) ; { | 1 | TS102 | applied
    | void loop() {⏎  F(1, 50);⏎} => LOOP(FOREVER);⏎  F(1, 50);⏎END_LOOP
^ do n=@num times :?
    | LOOP ( $n ) ; | 1 | TS102 | applied
    | hacer 4 veces⏎F(1,50)⏎R(1,50)⏎fin => LOOP(4)⏎F(1,50)⏎R(1,50)⏎END_LOOP
^ LOOP ':'|'{'? $
    | LOOP ( FOREVER ) | 3 | TS064 | applied
    | repite⏎S⏎fin => LOOP(FOREVER)⏎S⏎END_LOOP
LOOP X|=|-|-> n=@num
    | LOOP ( $n ) | 1 | TS015 | applied
    | X4 = 3⏎LOOP x 3⏎F(1,50)⏎END_LOOP => X4 = 3⏎LOOP(3)⏎F(1,50)⏎END_LOOP
^ LOOP <body> n=@num times $
    | LOOP ( $n ) ; $b $r ; END_LOOP | 1.5 | TS102 | applied
    | repeat F(1,60) R(1,60) 4 times => LOOP(4);F(1, 60);R(1, 60);END_LOOP
⟨LOOP¦SHOW⟩ ( n=@num u=⟨¦M|⟩@unit )
    | ⟨LOOP¦SHOW⟩ ( @own:n:u ) | 1 | TS049 | applied
    | ⟨LOOP(3 veces);F(1,50);END_LOOP¦SHOW(2 M)⟩ => ⟨LOOP(3);F(1,50);END_LOOP¦SHOW(200)⟩
LOOP n=number times :|,|do|;?
    | LOOP ( &n ) ; | 1 | TS102 | applied
    | repite cuatro veces⏎F(1,60)⏎fin => LOOP(4)⏎F(1,60)⏎END_LOOP
LOOP by? n=@num times|X? ⟨:|,|do|;¦b=@start|'{'¦$⟩
    | LOOP ( $n ) ⟨;¦; $b¦⟩ | 1 | TS102 | applied
    | repite 4⟨:⏎¦ ¦⏎⟩F(1, 60)⟨¦¦⏎fin⟩ => LOOP(4)⟨⏎¦;¦⏎⟩F(1, 60)⟨⏎¦;¦⏎⟩END_LOOP
o=(|,|=|<|>|+|- '|' v=@num|@val c=@noparen* '|'
    | $o ABS ( $v $c ) | 1 | TS010 | offered
    | D = |LIGHT_L - LIGHT_R|⏎SHOW(D) => D = ABS(LIGHT_L - LIGHT_R)⏎SHOW(D)
^ a=F|B|L|R|M|W|BEEP ( c=@noparen+ ) WHEN (? q=@cond+ )? ;|:|,? <body> $
    | WHEN ( $q ) ; $b $r ; END_WHEN ; $a ( $c ) | .9 | TS071 | offered
    | F(9, 50) WHEN(DISTANCE < 9) S => WHEN(DISTANCE < 9);S;END_WHEN;F(9, 50)
LOOP ( @name = 1 to|until n=@num )
    | LOOP ( $n ) | 1 | TS063 | offered
    | LOOP(I = 1 TO 5)⏎S⏎END_LOOP => LOOP(5)⏎S⏎END_LOOP
^ a=L|R ⟨n=@angle¦( n=@angle )⟩ $
    | $a ( $n DEG , 80 ) | 2 | ⟨TS015¦TS020⟩ | offered
    | L⟨ 90¦(90)⟩ => L(90 DEG, 80)
⟨a=F|B ( FOREVER¦a=RANDOM ( n=@whole¦a=ROUND ( n=@num|@val⟩ )
    | $a ( ⟨FOREVER , 80¦1 , $n¦$n , 0⟩ ) | 2 | TS020 | offered
    | ⟨F(FOREVER) UNTIL(DISTANCE < 10)¦SHOW(RANDOM(6))¦SHOW(ROUND(3))⟩ => ⟨F(FOREVER, 80)
    UNTIL(DISTANCE < 10)¦SHOW(RANDOM(1, 6))¦SHOW(ROUND(3, 0))⟩
^ a=F|B|L|R ( b=@num⟨|FOREVER ,? c=@num ,? UNTIL (? q=@noparen+ )?¦ , c=@num , d=@val e=<|> f=@num⟩
    ) $
    | $a ( $b , $c ) UNTIL ( ⟨$q¦$d $e $f⟩ ) | 2 | ⟨TS029¦TS020⟩ | offered
    | F(5, 60, ⟨UNTIL ¦⟩DISTANCE < 10) => F(5, 60) UNTIL(DISTANCE < 10)
h=IF|WHILE ( a=@val s=<|> b=@num , c=@val t=<|> d=@num )
    | &h ( $a $s $b AND $c $t $d ) | 2 | TS020 | offered
    | IF(DISTANCE < 10, LIGHT_R > 50)⏎S⏎ENDIF => IF(DISTANCE < 10 AND LIGHT_R > 50)⏎S⏎ENDIF
^ h=IF|WHILE ( c=@noparen+ , b=@start r=@noparen* ) $
    | &h ( $c ) ; $b $r | 2 | TS080 | applied
    | IF(DISTANCE < 10, S)⏎ELSE⏎F(1,50)⏎ENDIF => IF(DISTANCE < 10);S⏎ELSE⏎F(1,50)⏎ENDIF
LOOP|count v=@usedname =|from 1 to|until n=@num do|:?
    | $v = 0 ; LOOP ( $n ) ; $v = $v + 1 ; | .5 | TS102 | offered
    | para n desde 1 hasta 4⏎F(n, 60)⏎fin para => N = 0;LOOP(4);N = N + 1;⏎F(n, 60)⏎END_LOOP
<for> @name in range ( ⟨1 ,¦⟩ n=@num ) :?
    | LOOP ( $n ⟨- 1¦⟩ ) ; | 1 | TS102 | ⟨offered¦applied⟩
    | for i in range(⟨1, 5¦4⟩): F(1,60) => LOOP(⟨5 - 1¦4⟩);F(1, 60);END_LOOP
⟨LOOP|count @name =|from¦^ @name =⟩ 1 to|until n=@num do|:? ⟨¦$⟩
    | LOOP ( $n ) ⟨;¦⟩ | 1 | TS102 | offered
    | ⟨para i de¦veces =⟩ 1 a 4⏎F(1,50)⏎fin ⟨para¦⟩ => LOOP(4)⏎F(1,50)⏎END_LOOP
⟨LOOP¦<for>⟩ ( declare? @name = ⟨0¦1⟩ ; @name ⟨<¦<=⟩ n=@num ; @name ++ )
    | LOOP ( $n ) ⟨¦;⟩ | 1 | ⟨TS063¦TS102⟩ | offered
    | ⟨LOOP(I = 0; I < 4¦for(I = 1; I <= 4⟩; I++);F(1, 50);END_LOOP => LOOP(4);F(1, 50);END_LOOP
^ v=@name = c=@cond+ ? a=@num|@val : b=@num|@val $
    | IF ( $c ) ; $v = $a ; ELSE ; $v = $b ; ENDIF | 1 | TS069 | applied
    | V = DISTANCE > 20 ? 80 : 30⏎F(1, V) => IF(DISTANCE > 20);V = 80;ELSE;V = 30;ENDIF⏎F(1, V)
^ q=@val s=<|>|<=|>= n=@num|@val :|do|=|->|=>? b=@start r=@all*
    | IF ( $q $s $n ) ; $b $r | 1 | TS042 | offered
    | DISTANCE < 10: S => IF(DISTANCE < 10);S;ENDIF
^ ⟨FOREVER :¦FOREVER¦LOOP FOREVER :?⟩ $
    | LOOP ( FOREVER ) ⟨;¦¦⟩ | 1 | ⟨TS032¦TS032¦TS102⟩ | applied
    | ⟨forever:¦forever¦repetir siempre⟩⏎F(1,50)⟨¦⏎end¦⏎fin repetir⟩ =>
    LOOP(FOREVER)⏎F(1,50)⏎END_LOOP
^ FOREVER ( <body> ) $
    | LOOP ( FOREVER ) ; $b $r ; END_LOOP | 1 | TS080 | applied
    | FOREVER(F(1, 80)) => LOOP(FOREVER);F(1, 80);END_LOOP
^ FOREVER that c=@cond+ ⟨':'? b=@start|'{'¦':'? $⟩
    | WHEN ( $c ) ⟨; $b¦⟩ | 1 | TS102 | offered
    | siempre que DISTANCE > 10⟨: ¦⏎⟩F(1, 50)⟨¦⏎fin⟩ => WHEN(DISTANCE > 10)⟨;¦⏎⟩F(1,
    50)⟨;¦⏎⟩END_WHEN
^ @word+ same|the moment :|,? $
    | TASK | 1 | TS102 | applied
    | ⟨al mismo tiempo¦a la vez:¦at the same time¦ao mesmo tempo⟩⏎BEEP(1, 440)⏎FIN⏎F(2, 80) =>
    TASK⏎BEEP(1, 440)⏎END_TASK⏎F(2, 80)
⟨^ TASK @num ':'? $¦TASK ( @num|@word? )⟩
    | TASK | 1 | ⟨TS044¦TS039⟩ | offered
    | TASK⟨ 1¦(1)⟩⏎BEEP(1, 440)⏎END_TASK => TASK⏎BEEP(1, 440)⏎END_TASK
^ LOOP WHILE
    | WHILE | 1 | TS102 | first
    | repite mientras DISTANCE > 9⏎S⏎fin => WHILE(DISTANCE > 9)⏎S⏎END_WHILE
^ LOOP UNTIL c=@cond+ ':'|'{'? $
    | WHILE ( @not:c ) | 1 | TS102 | applied
    | repeat until DISTANCE < 10⏎F(1, 50)⏎end => WHILE(DISTANCE >= 10)⏎F(1, 50)⏎END_WHILE
⟨END_LOOP UNTIL ( c=@any+ )¦^ UNTIL c=@cond+⟩ $
    | IF ( $c ) ; <end> | ⟨1¦2⟩ | TS064 | ⟨offered¦applied⟩
    | LOOP⟨(FOREVER)¦⟩⏎F(1, 50)⏎⟨END_LOOP UNTIL(DISTANCE < 10)¦UNTIL DISTANCE < 10⟩ =>
    LOOP(FOREVER)⏎F(1, 50)⏎IF(DISTANCE < 10);BREAK;ENDIF;END_LOOP
^ LOOP ( n=@num ) UNTIL ( c=@any+ ) $
    | LOOP ( $n ) ; IF ( $c ) ; BREAK ; ENDIF | 1 | TS064 | offered
    | LOOP(3) UNTIL(DISTANCE < 10)⏎F(1, 40)⏎END_LOOP => LOOP(3);IF(DISTANCE < 10);BREAK;ENDIF⏎F(1,
    40)⏎END_LOOP
# how many times something is done, written after it or before it: number
⟨^ b=@step *|X? n=@num times? $¦call b=@step n=@num¦^ b=@step n=X2|X3|X4|X5|X6 $⟩
    | LOOP ( ⟨$n¦$n¦@xn:n⟩ ) ; $b ; END_LOOP | 1 | TS062 | applied
    | DEF SALTO;F(0.2, 60);END_DEF⏎⟨SALTO*3¦CALL SALTO 3¦SALTO x3⟩ => DEF SALTO;F(0.2,
    60);END_DEF⏎LOOP(3);SALTO;END_LOOP
^ ⟨n=@num times|X|* :|,|of? <body>¦n=@num *|X|times|LOOP? ( <body> )⟩ $
    | LOOP ( $n ) ; $b $r ; END_LOOP | 1 | ⟨TS062¦TS080⟩ | applied
    | ⟨3 * F(1,50)¦SI|3*(F(1,50))⟩ => ⟨¦SI|⟩LOOP(3);F(1, 50);END_LOOP
^ do|make? b=@start r=@any* n=@num times $
    | LOOP ( $n ) ; $b $r ; END_LOOP | 1 | TS062 | offered
    | hacer F(1,50) 3 veces => LOOP(3);F(1, 50);END_LOOP
# words after a call, shown and not made: branch
^ a=S|STOP ( ⟨n=@num|@val seconds?¦n=@num u=@unit⟩ )|$
    | $a ; W ( ⟨$n¦@own:n:u⟩ ) | 1 | TS039 | offered
    | S(⟨2¦500 ms⟩) => S;W(⟨2¦0.5⟩)
^ a=S|STOP during? n=@num seconds? ⟨$¦,? then* b=@start⟩
    | $a ; W ( $n ) ⟨¦; $b⟩ | 2 | TS013 | offered
    | S 2 segundos⟨¦ F(2, 80)⟩ => S;W(2)⟨¦;F(2, 80)⟩
^ b=F|B|L|R|S|STOP|BEEP|SHOW|W r=@any* IF c=@cond+ ELSE d=@start s=@all* $
    | IF ( $c ) ; $b $r ; ELSE ; $d $s ; ENDIF | .9 | TS071 | offered
    | F(2, 80) if DISTANCE > 10 else S => IF(DISTANCE > 10);F(2, 80);ELSE;S;ENDIF
# what the devices of a kit are set to: kind
d=@device v=⟨lit|on¦dark|off⟩ e=;|$
    | &d ( ⟨TRUE¦FALSE⟩ ) $e | 1 | TS015 | applied
    | LED ⟨ON¦OFF⟩ => LED(⟨TRUE¦FALSE⟩)
d=@device ( ⟨lit¦dark¦most¦least⟩ )
    | &d ( ⟨TRUE¦FALSE¦@most:d¦@least:d⟩ ) | 1 | TS102 | applied
    | ⟨LED(PRENDIDO)¦LED(LOW)¦PINZA(ABIERTA)¦GRIPPER(CLOSED)⟩ =>
    ⟨LED(TRUE)¦LED(FALSE)¦GRIPPER(180)¦GRIPPER(0)⟩
^ ⟨most¦least¦on|lit¦off|dark⟩ the|one? d=@device $
    | &d ( ⟨@most:d¦@least:d¦TRUE¦FALSE⟩ ) | 1 | TS102 | applied
    | ⟨ABRIR PINZA¦cerrar la garra¦prende el LED¦apagar el foco⟩ =>
    ⟨GRIPPER(180)¦GRIPPER(0)¦LED(TRUE)¦LED(FALSE)⟩
# DEF and its calls: kind, other
^ n=@defw = a=@num|@val , b=@num|@val $
    | $n ( $a , $b ) | 1 | TS015 | offered
    | DEF LADO(X, Y)⏎F(X, Y)⏎END_DEF⏎LADO = 3, 60 => DEF LADO(X, Y)⏎F(X, Y)⏎END_DEF⏎LADO(3, 60)
^ TO n=@word ':' v=@name
    ⟨¦':' u=@name¦':' u=@name ':' w=@name¦':' u=@name ':' w=@name ':' x=@name⟩ $
    | DEF $n ( $v ⟨¦, $u¦, $u , $w¦, $u , $w , $x⟩ ) | 1 | TS102 | applied
    | TO SIDE :X⟨¦ :Y¦ :Y :Z¦ :Y :Z :V⟩⏎SHOW(X⟨¦ + Y¦ + Y + Z¦ + Y + Z + V⟩)⏎END⏎
    SIDE(1⟨¦, 2¦, 2, 3¦, 2, 3, 4⟩) =>
    DEF SIDE(X⟨¦, Y¦, Y, Z¦, Y, Z, V⟩)⏎SHOW(X⟨¦ + Y¦ + Y + Z¦ + Y + Z + V⟩)⏎END_DEF⏎
    SIDE(1⟨¦, 2¦, 2, 3¦, 2, 3, 4⟩)
^ DEF n=@defw v=@usedname ,? u=@usedname ⟨¦,? w=@usedname¦,? w=@usedname ,? x=@usedname⟩ $
    | DEF $n ( $v , $u ⟨¦, $w¦, $w , $x⟩ ) | 1 | TS015 | applied
    | DEF LADO X⟨ Y¦, Y, Z¦ Y Z V⟩⏎SHOW(X + Y⟨¦ + Z¦ + Z + V⟩)⏎END_DEF⏎LADO(1, 2⟨¦, 3¦, 3, 4⟩) =>
    DEF LADO(X, Y⟨¦, Z¦, Z, V⟩)⏎SHOW(X + Y⟨¦ + Z¦ + Z + V⟩)⏎END_DEF⏎LADO(1, 2⟨¦, 3¦, 3, 4⟩)
n=@defw a=@num|@val
    ⟨¦,? b=@num|@val¦,? b=@num|@val ,? c=@num|@val¦
    ,? b=@num|@val ,? c=@num|@val ,? d=@num|@val⟩ e=;|$
    | $n ( $a ⟨¦, $b¦, $b , $c¦, $b , $c , $d⟩ ) $e | 1 | TS015 | applied
    | DEF LADO(X⟨¦, Y¦, Y, Z¦, Y, Z, V⟩)⏎SHOW(X⟨¦ + Y¦ + Y + Z¦ + Y + Z + V⟩)⏎END_DEF⏎
    LADO 1⟨¦ 2¦, 2, 3¦ 2 3 4⟩ =>
    DEF LADO(X⟨¦, Y¦, Y, Z¦, Y, Z, V⟩)⏎SHOW(X⟨¦ + Y¦ + Y + Z¦ + Y + Z + V⟩)⏎END_DEF⏎
    LADO(1⟨¦, 2¦, 2, 3¦, 2, 3, 4⟩)
DEF n=@word ( v=@word then|&|AND u=@word )
    | DEF $n ( $v , $u ) | 1 | TS017 | applied
    | DEF LADO(X y Z)⏎F(X, Z)⏎END_DEF⏎LADO(1, 60) => DEF LADO(X, Z)⏎F(X, Z)⏎END_DEF⏎LADO(1, 60)
n=@defw ( a=@num|@val then|&|AND b=@num|@val )
    | $n ( $a , $b ) | 1 | TS017 | applied
    | DEF LADO(X, Z)⏎F(X, Z)⏎END_DEF⏎LADO(1 y 60) => DEF LADO(X, Z)⏎F(X, Z)⏎END_DEF⏎LADO(1, 60)
^ DEF ( n=@word )
    | DEF $n | 1 | TS039 | offered
    | DEF(SALUDO)⏎BEEP(1,440)⏎END_DEF⏎SALUDO => DEF SALUDO⏎BEEP(1,440)⏎END_DEF⏎SALUDO
DEF n=@word ⟨:|'|'|=|'->'|'=>'¦b=@start|'{'⟩
    | DEF $n ; ⟨¦$b⟩ | 1 | TS014 | applied
    | DEF SALUDO⟨ = ¦ ⟩BEEP(1,440)⏎SALUDO => DEF SALUDO;BEEP(1, 440);END_DEF⏎SALUDO
DEF n=@word ( v=@noparen+ ) ⟨:|'|'|=|'->'|'=>'¦b=@start|'{'⟩
    | DEF $n ( $v ) ; ⟨¦$b⟩ | 1 | TS014 | applied
    | DEF LADO(X)⟨: ¦ ⟩F(X, 50)⏎LADO(3) => DEF LADO(X);F(X, 50);END_DEF⏎LADO(3)
n=@defw ( a=@noparen* b=@num u=seconds|@in_cm|@in_m|@in_deg c=@noparen* )
    | $n ( $a @own:b:u $c ) | 1 | TS049 | offered
    | DEF LADO(X)⏎F(X, 50)⏎END_DEF⏎LADO(2 s) => DEF LADO(X)⏎F(X, 50)⏎END_DEF⏎LADO(2)
^ call|do|make|the the|one? b=@def
    | $b | 1 | TS044 | applied
    | DEF SALTO;F(0.2, 60);END_DEF⏎hacer SALTO => DEF SALTO;F(0.2, 60);END_DEF⏎SALTO
# ends of blocks: kind
^ ⟨end¦END_DEF⟩ n=@def $
    | END_DEF @label:n | 1 | ⟨TS022¦TS044⟩ | ⟨applied¦first⟩
    | DEF SALTO⏎F(1, 50)⏎⟨FIN¦END_DEF⟩ SALTO⏎SALTO => DEF SALTO⏎F(1, 50)⏎END_DEF⏎SALTO
^ ⟨program @word¦then ,?⟩ $ | | 1 | TS044 | applied | ⟨programa baile¦luego,⟩⏎F(1, 50) => ⏎F(1, 50)
^ ⟨leaves 0¦import @any+⟩ ;? $
    | | 1 | ⟨TS065¦TS072⟩ | applied
    | ⟨return 0;¦import robot⟩⏎F(1, 50) => ⏎F(1, 50)
^ closing $$ | | 0 | TS044 | first | F(1, 50)⏎fimalgoritmo => F(1, 50)⏎
^ end program? $$ | FIN | 0 | TS044 | first | F(1, 50)⏎fin programa => F(1, 50)⏎
end -|.|of|the? k=IF|LOOP|WHILE|DEF|FOREVER|count ;|$
    | @endof:k | 1 | TS022 | first
    | definir bailar⏎L(1,50)⏎fin definir⏎bailar => DEF bailar⏎L(1,50)⏎END_DEF⏎bailar
# what joins instructions: kind, other
⟨^ by? please|first ,?¦; first+ ,?⟩ b=@start
    | ⟨¦;⟩ $b | 1 | TS044 | applied
    | ⟨please¦F(2, 80); y despues⟩ R(1, 50) => ⟨¦F(2, 80);⟩R(1, 50)
^ ( <body> ) $ | $b $r | 1 | TS080 | applied | (F(2,80), R(1,60)) => F(2, 80);R(1, 60)
a=@close ⟨by? please+¦CM|@in_cm|@in_secs+⟩ $
    | $a | 1 | TS044 | applied
    | SHOW(DISTANCE) ⟨por favor¦cm⟩ => SHOW(DISTANCE)
^ a=F|B ( n=@num , p=@num ) CM|@in_cm $
    | $a ( $n CM , $p ) | .5 | TS076 | offered
    | F(20, 60) CM => F(20 CM, 60)
( a=@num , p=@num|@val ) then|&|+|AND BEEP ( b=@num
    | ( $a , $p ) ; BEEP ( @same:a:b | .9 | TS074 | offered
    | F(2, 80) AND BEEP(2, 440) => F(2, 80);BEEP(2, 440)
a=@close ⟨,? then|soon+ ,? b=@start¦,|.|:? b=@start¦&|+|AND b=@startm¦->|=>|/|>|>>|_|*|-|'|'
    b=@start⟩
    | $a ; $b | 1 | ⟨TS044¦TS013¦TS061¦TS061⟩ | applied
    | F(1, 75)⟨ y¦,¦&¦->⟩ R(1, 75) => F(1, 75);R(1, 75)
a=@close ⟨comma¦point then comma⟩ b=@start
    | $a ; $b | 1 | TS061 | applied
    | F(2, 80) ⟨coma¦ponto e vírgula⟩ L(1, 50) => F(2, 80);L(1, 50)
a=@close ⟨+|&|AND|->|'|'¦,⟩ $
    | $a ; | ⟨1¦.8⟩ | ⟨TS061¦TS013⟩ | applied
    | F(2, 80)⟨ +¦,⟩⏎R(1, 50) => F(2, 80)⏎R(1, 50)
# words of other languages around a program: kind, code
⟨read ( v=@val )¦^ read the? v=@val $⟩
    | $v | 1 | TS102 | applied
    | ⟨X = leer(DISTANCE)¦leer DISTANCE⟩ => ⟨X =DISTANCE¦DISTANCE⟩
^ ⟨no F|B|L|R|M extra?¦cease of F⟩ $
    | S | .5 | TS102 | first
    | ⟨no avanzar mas¦para de avanzar⟩ => S
^ off|S the? engine $ | S | 1 | TS102 | applied | apaga motores => S
IF <question> BREAK ;|$
    | IF ( $c ) ; BREAK ; ENDIF ; | 1 | TS014 | applied
    | LOOP(3)⏎S⏎IF(DISTANCE < 10) BREAK⏎END_LOOP => LOOP(3)⏎S⏎IF(DISTANCE < 10);BREAK;ENDIF⏎END_LOOP
^^ declare|DEF? main ( ) '{'
    | START ; { | 1 | TS065 | applied
    | main() {⏎F(3, 70);⏎} => START;⏎F(3, 70);⏎
"""
