"""Suggestions if no repair is read: for words next to instructions, and for the text found.

`SUGGESTIONS` has these columns, and the first row that applies is reported:

    pattern | code | values | example => one of the values, or the code

A pattern is one of `rows`. Its first token is the subject of the row, the others are the tokens
after it:

1. A whole instruction, with its brackets and its UNTIL, before words. Its classes, besides its
   word:
   @cmd (of the language), @did (a DEF), @more (others stand before it on its line), @later (others
   stand before it), @outer (in no block), @move, @clock (its first value is its time), @asked (has
   its UNTIL) and @unasked (may get one).
2. No instruction: @none, before words; also @after, if one is before them, @opening, if
   they are the first of several lines, @last where they end the text, and @unbegun in a text
   without `SI|`.
3. A finding of a check of the text, TS015, before its instruction; also @strange
   (a word that nobody knows begins it), and @TS033_PING, with what stands there. `usage` has more.

Classes of the words of 1 and 2: @number (in words, too), @often (a number of repetitions), @percent
(one that says a power), @in_s (a unit of time), @other (the other way), @paced (another pace than
its power), @told (says nothing that the instruction does not), @quote, @mark (what is written below
a line that is meant again), @dots, @ask (a word of the language that asks) and @noBUTTON (a word
for BUTTON, which the kit lacks), @call and @order (of the language: with values, or without); of 3:
@quote, @known (of the language), @loose (a first word that means nothing) and @button. The message
points at the text that `s` captures. `h` is a header: the rest is read with the question in it, or
with TRUE if it has none.

A code `=` is that which was found, with its values. Behind it stands where it is told, if not
there, `here` (the instruction) or a place of `usage`, and what is done with it: `offered` (its fix
takes the place of the instruction, if somebody says so), `whole` (its fix stands for that),
`everywhere` (`right` is written in each place of a name), `again` (rows speak of it once more).

Values are texts with gaps. A gap is a capture, or a function: of 1 and 2 in `suggestions`, of 3 in
`usage`; a row with a gap that cannot be filled does not hold, unless `?` follows its name.
`?=` must be filled and is not told, `*=` are values that come together. `⟨less¦more⟩` makes a row
of each, and a row goes on in lines that are indented, as in `rows`. Rows are sorted by their
purpose; a heading names the laws of `rows` that the rows below it obey and no stranger's program
needs.
"""

# Pieces of patterns that several rows have.
PARTS = {
    "lead": """[|,|=|:|"|(?""",
    "close": """]|"|)?""",
    "does": "c=@cmd|@did",
    "again": "then|filler* same then|filler|same|above*",
    "rest": ",? then*",
    "either": "(? l=light|ahead r=<|>|<=|>= n=@num )?",
    "asks": "h=@ask",
    "body": "do|:?",
    "often": "*|LOOP|X|times|during? n=@often times|X?",
    "call": "w=@call ( v=@noparen+ )",
    "moment": "s=@word+ k=same|the t=moment",
}

SUGGESTIONS = """
# what stands for what is above it, and for what follows: code
^ @after <again> $ | TS130 | right={above?} | F(2, 80)⏎igual que arriba => right=F(2, 80)
^ @after <again> by? n=@often times ⟨¦extra ⟩$
    | TS130 | right=; often={⟨all¦more⟩}
    | F(2, 80)⏎otra vez ⟨3¦2⟩ veces⟨¦ mas⟩ => often=LOOP(3);F(2, 80);END_LOOP
^ @after|@later ⟨<rest> etc @any*¦<rest> so forth @any*¦,? and forth so|all?¦,? @dots+⟩ $
    | TS131 | found={said}; all={often?}
    | F(2, 80)⏎⟨etc.¦y asi siempre¦y todo eso¦...⟩ => all=LOOP(4);F(2, 80);END_LOOP
^ @after ⟨¦@num .|) ⟩goback to the|one? beginning|1 $
    | TS131 | found={said}; endless={endless}
    | F(1, 80)⏎⟨GO TO START¦3. voltar ao 1⟩ => endless=LOOP(FOREVER);F(1, 80);END_LOOP
# notes: branch, number, code
^ @none TSC @any* $ | TS073 | command={said}; words= | SI|F(1, 80)⏎tsc upload => command=tsc upload
# how many times, before what is repeated, and a loop after it: number
^ @none 1|@one times :? $ | TS062 | found={words}; line={said} | 1 vez:⏎S => line=1 vez
^ @none n=@number times :? $ | TS062 | found={words}; fix=LOOP({n}) | 4 veces:⏎S => fix=LOOP(4)
^ @last repeat (? n=@num? )? times? $
    | TS062 | found={words}; all={all?}
    | F(1, 50)⏎repetir 3 => all=LOOP(3);F(1, 50);END_LOOP
^ @opening launch $ | TS102 | found={words}; right=SI|; usage=SI|; fix= | go⏎S => right=SI|
# questions in words: branch, kind, two
^ @opening when|at|to? @word? @noBUTTON @word? pressed? $
    | TS102 | found={words}; right=SB|; usage=SB|; fix=
    | on button pressed⏎S => right=SB|
^ @unbegun when|at @word* flag @word* $
    | TS102 | found={words}; right=SI|; usage=SI|; fix=
    | when green flag clicked => right=SI|
^ ⟨@unbegun¦@none⟩ when|at @word? @word? beginning :? $
    | TS102 | found={words}; right=⟨SI|¦START⟩; usage=⟨SI|¦START⟩; fix=⟨¦START⟩
    | ⟨¦SI|⟩on start => right=⟨SI|¦START⟩
^ @none @any* h=IF|ELSEIF|WHILE|UNTIL (? @any* s=@noBUTTON @any* )? <body> $
    | TS120 |
    | IF(boton presionado)⏎S⏎ENDIF => before=
^ @none @any* <asks> (? '='|@word* s=unsensed @any* )? <body> $
    | TS103 | found={s}; unsensed={s}; sensors={sensors}; near=; words=
    | IF(COLOR = RED)⏎S⏎ENDIF => unsensed=RED
^ @none @any* h=WHEN (? @word* every|each n=@number u=@in_s )? <body> $
    | TS135 | seconds={n}; every=TASK;LOOP(FOREVER);W({n});...;END_LOOP;END_TASK
    | WHEN(cada 5 segundos)⏎S⏎END_WHEN => seconds=5
^ @none @any* <asks> (? s='='|@word|@num+ )? <body> $
    | TS135 | word={head}; *=question
    | F(5, 60) UNTIL(luz mucha) => question=LIGHT_L > 500
^ @none @any* <asks> ( v=@word s=@num ) <body> $
    | TS048 | before={v}; found={s}; words=
    | IF(DISTANCE 10)⏎S⏎ENDIF => found=10
^ @none g=IF|WHILE ( s=@any+ , w=@start @any* ) $
    | TS080 | word={block}; head={block}({s}); right={end}
    | IF(distancia < poca, S) => head=IF(distancia < poca)
^ @none s=FOREVER t=that q=@cond+ @startm $
    | TS102 | found={s} {t}; right=WHEN; usage=WHEN({question})
    | siempre que distancia > 20 avanza => usage=WHEN(DISTANCE > 20)
# what asks or calculates, alone: branch, two, code
^ @none IF <either> do? w=@start @any* $
    | TS042 | found={l}; asked={l} {r} {n}; one=IF({one} {r} {n});{then};ENDIF; another=IF({two} {r}
    {n});{then};ENDIF
    | si luz > 50 apita => another=IF(LIGHT_R > 50);BEEP(1, 440);ENDIF
^ @none <either> @any* $
    | TS042 | found={l}; asked={l} {r} {n}; one=IF({one} {r} {n})
    | pared > 50: F(2, 80) => one=IF(DISTANCE > 50)
^ @none s=@cond+ $
    | TS042 | found={s}; asked={s}; fix=IF({alone})
    | DISTANCE < 20 => fix=IF(DISTANCE < 20)
^ @none v=@word|@num|+|-|*|/|%|(|)+ = x=@name $
    | TS042 | found={x}; turned={x}; fix={free} = {v}
    | DISTANCE - 5 = FALTA => fix=FALTA = DISTANCE - 5
^ @none v=@name = s=[ @any* $ | TS067 | found={v} | NOTAS = [50, 60] => found=NOTAS
^ @none s=cases ⟨( v=@word ¦⟩@any* $
    | TS066 | found={s}; first=IF(⟨{v}¦X⟩ = 1)⟨; second=ELSEIF({v} = 2)¦⟩
    | ⟨SWITCH(X)¦CASE 1: F(1, 50)⟩ => first=IF(X = 1)
^ @none most|least|on|off the|one? s=@noGRIPPER|@noLED $
    | TS101 | found={s}; near=
    | OPEN GRIPPER => found=GRIPPER
# an order that is chosen, or stands for a value: two, code
^ @none RANDOM ( l=@any+ ) $
    | TS136 | fix={choice}; example={choices}
    | RANDOM(L(1, 60), S) => fix=IF(RANDOM(1, 2) = 1);L(1, 60);ELSE;S;ENDIF
^ @none @any* RANDOM ( l=@any+ ) $
    | TS136 | example={choices}
    | giro = RANDOM(L, R) => example=IF(RANDOM(1, 2) = 1); L(2, 80); ELSE; R(2, 80); ENDIF
^ @none RANDOM ( n=@num to|, m=@num ) $
    | TS042 | found=RANDOM; given={words}; number={number} = RANDOM({n}, {m})
    | RANDOM(440 a 880) => number=N = RANDOM(440, 880)
^ @none @any* SHOW|UNTIL|M (|, s=L|R ) $
    | TS051 | word={s}; reading={reading}
    | F(2, 80) UNTIL(L) => reading=LIGHT_L
^ @none w=F|B|L|R|M|BEEP ( u=-|@num|@val+ , v=-|@num|@val+ , s=@order ) $
    | TS051 | word={s}; apart={w}({u}, {v});{next}
    | F(1, 60, S) => apart=F(1, 60);S
^ @none w=@call @any* (|, s=@order ) $
    | TS051 | word={s}; example={example}
    | F(2, R) => example=F(2, 80)
# words for nothing, followed by others that are no words: number
^ c=F|B CM|@in_cm $ | TS085 | fix={by_way} | F(20, 60) cm => fix=F(20 CM, 60)
# how many times: number, two
^ c=@more <lead> <often> <close> $
    | TS062 | found={text}; last={loop}; all={all}
    | F(1, 60); L(1, 60) x4 => last=LOOP(4);L(1, 60);END_LOOP
^ <does> <lead> <often> <close> $
    | TS062 | found={text}; fix={loop?}; once={once?}
    | F(2, 80) 3 veces => fix=LOOP(3);F(2, 80);END_LOOP
^ c=⟨S|STOP¦M⟩ (? during? n=@number u=@in_s⟨?¦⟩ )? $
    | TS085 | fix={c};W({n})⟨¦;S⟩
    | ⟨S 2¦M(50, 50) 2 segundos⟩ => fix=⟨S¦M(50, 50)⟩;W(2)⟨¦;S⟩
^ c=S|STOP during? n=@number u=@in_s? ,? then* w=@start @any* $
    | TS085 | fix={c};W({n});{behind}
    | STOP 2 s THEN F(2, 80) => fix=STOP;W(2);F(2, 80)
^ c=M (? n=@time )? $
    | TS085 | seconds={n}; waiting={c};W({n});S
    | M(50, 80) 2 => waiting=M(50, 80);W(2);S
^ c=@cmd (? n=@time )? $
    | TS085 | times={n}; often={loop}
    | F(2,80)(3) => often=LOOP(3);F(2,80);END_LOOP
^ ⟨<does> one then anew times¦c=@cmd count? FOREVER⟩ $
    | TS085 | endless=LOOP(FOREVER);{c};END_LOOP
    | F(1, 80) ⟨una y otra vez¦siempre⟩ => endless=LOOP(FOREVER);F(1, 80);END_LOOP
^ <does> @any* anew @any* $
    | TS085 | again=LOOP(2);{c};END_LOOP
    | F(1, 80) again => again=LOOP(2);F(1, 80);END_LOOP
^ @none TASK s=@num :|.|-|=|)? r=@any+ $
    | TS044 | found={s}; fix=TASK;{r};END_TASK
    | TASK 1: F(5, 60) => fix=TASK;F(5, 60);END_TASK
# how long: number
^ c=@clock <lead> during|to|then|X? n=@number u=@in_s <close> t=UNTIL? q=@any* $
    | TS085 | time={n} s; longer={longer}{until?}
    | F(2,80) por 5 segundos => longer=F(5,80)
# how fast: number, two
^ c=@move ⟨<lead> @told* n=@percent @told* <close>¦A n=@num⟩ $
    | TS085 | power={paced}
    | F(2,80) ⟨al 50%¦a 50⟩ => power=F(2,50)
^ c=@move @word? @word? @paced $ | TS085 | power={c} | F(2, 80) despacio => power=F(2, 80)
# until when: branch, two
^ c=@cmd s=WHEN (? q=@cond+ )? w=@start @any* $
    | TS071 | found={s}; fix=WHEN({question});{then};END_WHEN;{c}
    | F(10, 50) WHEN DISTANCE < 15 BEEP(1, 440) => fix=WHEN(DISTANCE < 15);BEEP(1,
    440);END_WHEN;F(10, 50)
^ c=@move|W s=WHILE (? q=@cond+ )? $
    | TS071 | found={s}; fix={c} UNTIL({contrary})
    | F(2, 80) while DISTANCE > 10 => fix=F(2, 80) UNTIL(DISTANCE <= 10)
^ <does> s=IF (? q=@cond+ )? $
    | TS071 | found={s}; fix=IF({question});{c};ENDIF
    | S IF(DISTANCE < 10) => fix=IF(DISTANCE < 10);S;ENDIF
^ c=@move s=WHILE @word* no @word* wall $
    | TS071 | found={s}; fix={c} UNTIL({distance} < 10)
    | F(2, 80) mientras no haya pared => fix=F(2, 80) UNTIL(DISTANCE < 10)
^ c=@cmd s=when @word* no @word* wall $
    | TS071 | found={s}; fix=IF({distance} > 10);{c};ENDIF
    | S cuando no hay pared => fix=IF(DISTANCE > 10);S;ENDIF
^ c=@unasked h=UNTIL s=@word+ $
    | TS135 | word={head}; *=question
    | F(2, 80) hasta negro => question=LIGHT_L < 500
# which way, and what comes next: branch, two
^ c=@cmd then|+|&|,|beside? <call> <moment> $
    | TS061 | found={s} {k} {t}; together=TASK;{w}({v});END_TASK;{c}
    | F(2, 80) y BEEP(1, 440) al mismo tiempo => together=TASK;BEEP(1, 440);END_TASK;F(2, 80)
^ c=@more|@later @word+ same|the moment $
    | TS061 | found={words}; together=TASK;{c};END_TASK;{above}
    | F(2, 80); BEEP(1, 440) a la vez => together=TASK;BEEP(1, 440);END_TASK;F(2, 80)
^ @after <moment> :? $
    | TS061 | found={s} {k} {t}; together=TASK;...;END_TASK;{above}
    | F(2, 80)⏎al mismo tiempo => together=TASK;...;END_TASK;F(2, 80)
^ c=@move s=+|&|AND|then|beside w=BEEP ( v=@noparen+ ) @word* $
    | TS061 | found={s}; both=TASK;{w}({v});END_TASK;{c}
    | F(2, 80) con BEEP(1, 440) => both=TASK;BEEP(1, 440);END_TASK;F(2, 80)
^ c=@cmd then @any+ $
    | TS074 | fix={orders}; example={made_up?}
    | F(1, 80) then wait 2 then B(1, 80) => fix=F(1, 80);W(2);B(1, 80)
^ c=@move ⟨to reversed¦<lead> @told* @other @told* <close>⟩ $
    | TS085 | other={other}
    | F(1, 80) ⟨al reves¦atras⟩ => other=B(1, 80)
^ ⟨c=@cmd w=act|most|least @told*¦c=@cmd with w=@start|act @any*¦c=@asked or w=@start @any*⟩ $
    | TS085 | order={behind}
    | ⟨F(1, 80) abre la pinza¦F(2,80) con SHOW(1)¦F(1,50) UNTIL(DISTANCE<10) o SHOW(1)⟩ =>
    order=⟨abre la pinza¦SHOW(1)¦SHOW(1)⟩
^ c=@cmd or l=@any+ $
    | TS136 | fix={choice}; example={choices}
    | L(1, 60) o R(2, 60) => fix=IF(RANDOM(1, 2) = 1);L(1, 60);ELSE;R(2, 60);ENDIF
# notes: branch, number, code
^ @none SHOW s=@newname @word* $ | TS070 | words={shown} | SHOW Hola => words=Hola
^ c=@any w=@told+ $
    | TS085 | fix={note?}
    | F(1, 80) voy a la bodega => fix=F(1, 80) // voy a la bodega
^ c=@cmd|@set (|,? @num @any* $ | TS085 | extra={words} | F(2,80) (2,80) => extra=(2,80)
^ c=@outer LOOP $
    | TS085 | again=LOOP(2);{c};END_LOOP
    | F(1, 80) repite => again=LOOP(2);F(1, 80);END_LOOP
^ c=@cmd @word|@number+ $
    | TS074 | fix={orders}; example={made_up?}
    | F(2, 80) gira a la derecha => fix=F(2, 80);R(2, 80)
^ c=@cmd ⟨" w=@noparen+ "¦( w=@any+ )⟩ $
    | TS085 | order={w}
    | F(1, 80) ⟨"y gira"¦(y gira)⟩ => order=y gira
# a word that nobody knows, an end, a part of a thing, words to show, a count: kind
^ @strange end @word? @word? $
    | TS023 offered here | found={said}; right={end}; fix={end}
    | for each paso in 4⏎F(1, 50)⏎end => found=end
^ @strange end @word? @word? $ | = | | square⏎F(1,50)⏎end⏎square => found=END
^ @pressed | TS120 | *=button | wait for button => asked=button
^ @strange @word .
    | TS102 member | found={member}; right={done}; usage={done_usage?}
    | robot.adelante() => found=robot.adelante
^ @strange @word . | TS101 member | found={member} | servo.write(90); => found=servo.write
^ @strange SHOW @any* @quote | TS070 | | PRINT "hola" => TS070
^ @instead | = | *=instead | RETURN => found=RETURN
^ @strange @loose @num $ | TS050 offered here | fix={first} = {sign} | PUNTOS 5 => fix=PUNTOS = 5
^ @strange @loose ++|--|+|-
    | TS050 offered here | found={sign}; fix={first} = {first} {step} {number}
    | x++ => found=++
^ @strange | = | surplus={until_end} | UNTIL(DISTANCE < 15)⏎F(50)⏎END_UNTIL => surplus=END_UNTIL
^ @strange | = | near={likely} | BESO(1, 880) => near=BEEP
# … a sentence that says a block, an order or several: branch, two, code
^ @strange
    | TS102 offered | fix={block}; right={right}; found={named_first}; usage={usage}; takes=
    | SE DISTANCE < 10 APITA => fix=IF(DISTANCE < 10);BEEP(1, 440);ENDIF
^ @strange
    | TS102 offered | fix={order}; right={right}; found={named}; usage={usage}; takes={takes?}
    | PIIIII => fix=BEEP(1, 440)
^ @strange
    | TS074 here | right={sided}; example={made_up?}
    | avanza, gira, avanza, gira => right=F(2, 80);R(2, 80);F(2, 80);R(2, 80)
^ @strange
    | TS074 offered here | fix={several}; example={made_up?}
    | esperar 2 segundos luego avanzar => fix=W(2);F(2, 80)
^ @switched | TS122 | found={lamp_named?}; fix={lamp_set?} | PRENDER => TS122
^ @button | TS120 | *=button | SB|botão⏎F(2, 80) => begun=SB|
^ @strange
    | TS102 offered | ?={endless}; fix=LOOP(FOREVER); right=LOOP; found={named_endless};
    usage={usage}; takes=
    | por siempre => right=LOOP
# … a turn that says no way, or no number: branch, two, code
^ @turned | TS074 here | ?={others} | avanza y gira a la derecha 4 veces => TS074
^ @turned
    | TS121 | right={way}({angle} DEG, 60); word={way}; way={side}
    | girar(derecha, 90) => right=R(90 DEG, 60)
^ @turned | TS121 | to_left=L{turned}; to_right=R{turned} | u turn => to_left=L(180 DEG, 60)
^ @turned | TS121 | word={way?}; way={side?}; usage={way_usage?} | VUELTA(3) => TS121
# … a word of another language, prose, a word of its own: kind, code
^ @strange
    | TS135 | word={asking}; *=in_words
    | hasta que distancia < 10⏎avanza(1,50)⏎fin => word=UNTIL
^ @strange
    | TS102 offered | fix={concept_alone}; right={concept}; found={word_said}; usage={usage}; takes=
    | EXIT => right=BREAK
^ @strange | TS074 here | ?={concept_numbered} | salir 3 => TS074
^ @strange
    | TS102 | found={word_said}; right={concept}; word={concept}; *=one_number
    | fd 50 => way=F(50 CM, 80)
^ @strange | TS102 | found={word_said}; right={concept}; usage={concept_usage?} | fd x => found=FD
^ @sentence
    | TS073 here | name={variable}; example={variable} = {variable} {plus} {number}; fix=
    | N = 5⏎cambiar N por -1 => example=N = N - 1
^ @sentence | TS073 offered here | fix=// {said} | CALL DANCE => fix=// CALL DANCE
^ @strange | = | near={often_taught} | Si|Loco(4)⏎F(1, 60)⏎L(0.39, 60)⏎End_loop => near=LOOP
^ @strange | = | taught={taught} | SALTO(3) => taught=SALTO
^ @strange | TS129 | name={untaught}; often={often?} | SALTO() => name=SALTO
^ @strange | = | own={own} | SI|FRFL => own=FRFL
# a word without its brackets: branch, kind
^ TS015 @any* @button | TS120 | *=button | F boton => asked=boton
^ @bare | = offered | fix={block} | if see obstacle stop => fix=IF(DISTANCE < 10);STOP;ENDIF
^ @bare | = offered | fix={order} | F => fix=F(2, 80)
^ @bare | TS074 here | right={sided}; example={made_up?} | F y gira => right=F(2, 80);R(2, 80)
^ @bare
    | TS074 offered here | fix={several}; example={made_up?}
    | F 2 segundos y luego S => fix=F(2, 80);S
^ TS015 | TS135 | word={bare_asking}; *=in_words | IF BRIGHT THEN STOP => word=IF
^ TS015
    | = | *=bound
    | F(2, MAX); B(2, MIN) => greatest=F(2, 100)
^ TS015 | = | word={word}; *=one_number | F 50 => way=F(50 CM, 80)
^ TS015 | = | example={bare_example?}; usage={bare_usage?} | SHOW => example=SHOW(DISTANCE)
# a side of what a robot sees, or a lamp, in a letter that turns the robot: other
^ TS051 | = | reading={reading} | IF(L > 500)⏎S⏎ENDIF => reading=LIGHT_L
^ TS020 L ( ⟨lit|on|TRUE¦dark|off|FALSE⟩ ) $
    | TS122 here | lamp={said}; switch={lamp?}; fix={lamp_⟨on¦off⟩?}
    | L(⟨ON¦OFF⟩) => lamp=L(⟨ON¦OFF⟩)
^ TS039 S|STOP ( @num ) $ | = offered | fix={first};W({number}) | F(50);S(1) => fix=S;W(1)
# what is no value, in brackets or after one: number, branch
^ TS017
    | TS049 offered | ?={unit}; fix={without_seconds}; found={here}
    | F(RANDOM(1, 3) sec, 50) => fix=F(RANDOM(1, 3), 50)
^ TS017 | TS049 whole | fix=; found={unit} | F(RANDOM(1,3) min, 50) => found=min
^ TS017
    | TS049 | found={number_said}; fix=; right={way_said?}
    | BEEP(1 segundo, nota DO) => found=1 segundo
^ TS017
    | TS053 | name={value_name}; wanted={wanted}; unit={value_found}; word={value_word};
    usage={value_usage}
    | SI|F(3 VOLTAS, 75)⏎R(90 DEG, 50)⏎F(3 VOLTAS, 75)⏎BEEP(1, 440) => name=time
^ TS017
    | TS076 | fix=; extra={extra}; word={value_word}; usage={value_usage}
    | F(2 VEL)⏎S => extra=VEL
^ TS088 | = | example={own_example} | F(1 + 20 CM + 3, 60) => example=F(1 + 20 + 3 CM, 60)
^ @values @known ( $ | = | usage={first_usage} | W( => usage=W(seconds)
^ @values | TS101 first again | found={foreign} | CUADRADO(2 3) => found=CUADRADO
^ @values|TS009 | TS103 amount | found={amount}; *=amount | W(más) => found=más
^ @values SHOW @any* @word | TS070 | | SHOW(hello world) => TS070
^ @values
    | TS135 | word={in_words}; *=in_brackets
    | IF(distancia a la pared < 10)⏎S⏎ENDIF => word=IF
^ TS103 | = | near=; meant=FOREVER; endless={endless_move} | F(INFINITO, 50) => meant=FOREVER
^ TS103 | TS135 | word={in_dark}; *=in_dark | IF(distancia < poca)⏎S⏎ENDIF => word=IF
^ TS013
    | TS085 behind | before={before}; words={words_behind}; order={words_behind}
    | F (2) (80) => before=F (2)
^ TS087
    | = | started={started}; waiting=TASK;W(FOREVER) UNTIL({started} = 1); set={started} = 1;
    zero={started} = 0
    | TASK SIREN⏎BEEP(1, 440)⏎END_TASK⏎F(1, 60)⏎SIREN⏎F(3, 60) => set=SIREN = 1
# a beginning in another place, or in other words: branch, kind
^ TS013
    | TS033 | found={begun_behind}; here={begun_behind}; button={button_behind?}; pause=W(2);
    twice=; instead=
    | F(2, 80)|SB => button=SB
^ TS034 | = | ?={saying_button}; right=SB| | Boton|F(2,80) => right=SB|
^ @twice
    | TS102 offered here | fix={arm}; found={said}; right={arm}; usage={arm}
    | SI NO => found=SI NO
^ @TS033_CHECK_CONNECTION | TS035 | | PING;CHECK_CONNECTION => TS035
^ @TS033_PING | TS036 | found=PING; fix=PING| | SI|PING => found=PING
^ @twice
    | TS045 offered | fix={block}
    | SI(DISTANCE < 10) APITA => fix=IF(DISTANCE < 10);BEEP(1, 440);ENDIF
^ @twice
    | TS135 | word={question_begun}; *=in_words
    | SI|F(3, 50)⏎si hay una pared cerca BEEP(1, 440)⏎si no hay nada sigue otra vez => word=IF
^ @twice | TS045 | ?={question_begun} | F(2, 80)⏎si adelante => TS045
^ @TS033_SB
    | = | found={begun_again}; here={begun_again}; button=SB; pause=W(2); twice={twice?};
    instead={instead?}
    | F(1,80)⏎SB => found=SB
^ @twice
    | = | found={begun_again}; here={begun_again}; button=; pause=W(2); twice=; instead={instead?}
    | SB|SI|F(2,80) => found=SI|
# blocks: branch
^ TS024 | = | *=unended | DEF A - => word=DEF
^ TS025 | = | part={part} | SI|WHEN(DISTANCE < 15)⏎B(1, 60)⏎ELSE⏎F(1, 60)⏎END_WHEN => part=ELSE
^ TS120 | TS120 | *=button | SHOW(boton) => asked=boton
^ TS029
    | = | used={until_block}; endless={until_endless}
    | UNTIL(DISTANCE < 15)⏎F(50)⏎END_UNTIL => endless=F(FOREVER, 50) UNTIL(DISTANCE < 15)
^ TS029 | = | example={asked_behind?} | until distance < 10 forward => word=UNTIL
^ TS032
    | = | fix={forever_first}
    | SI|WHEN(TIME() = 5, S)⏎F(50, FOREVER) => fix=F(FOREVER, 50) UNTIL(DISTANCE < 10)
# signs and names: sign, kind, code
^ @upside
    | TS073 offered here | fix=// {said}
    | Claro, aquí tienes el programa:⏎F(2, 80)⏎R(1, 50)⏎¡Espero que te ayude! => fix=// Claro, aquí
    tienes el programa:
^ TS005 | TS102 | found={here}; right={sign_means}; usage={sign_usage} | ⬆ => found=⬆
^ TS005 | TS082 dots | *=dots | LOOP(3)⏎...⏎END_LOOP => head=LOOP(3)
^ @negating | TS010 | found=!; right=NOT | IF(!DARK);S;ENDIF => found=!
^ TS005 | TS008 | found={two_digits} | F(0:30,80) => found=0:3
^ @brace | TS047 | found={here} | LOOP(3)⏎F(1,50)⏎} => found=}
^ @quoted SHOW | TS070 quoted | | SHOW('hola') => TS070
^ @quoted | TS006 quoted | found={here} | F(", 80) => found="
^ TS105
    | TS105 everywhere | word={word}; since={since?}; right={everywhere}; line={name_line?};
    lines={name_lines?}; times={name_times?}
    | S = 5 => word=S
^ @clocked
    | = | right={time_right?}; clock={clock?}; line={time_line?}; lines={time_lines?}
    | F(2, 60)⏎TIME = 0⏎WHILE(TIME < 10)⏎L(1, 40)⏎END_WHILE => clock=TIME_1
^ TS105 | = | right={name_right?} | cuadrado = LOOP(4) => word=LOOP
^ TS042 ( @any+ ) $
    | = | unnamed={said}; one={taking_one}; another={taking_another?}; button={waiting?}
    | SB|(2, 60) => one=F(2, 60)
^ TS042 | TS007 | found={note} | /* hola */ F(2,80) => found=/*
^ TS046 | TS039 | word={sensor}; right={sensor} | IF(DISTANCE(cm) < 10);S;ENDIF => word=DISTANCE
^ TS046 | TS068 | ?={input} | X = input()⏎F(X, 80) => TS068
^ TS009 | TS122 | lamp={lamp_here} | LÂMPADA(1) => lamp=LÂMPADA
^ TS009
    | TS102 | found={plain_letters}; right={letters_mean}; usage={letters_usage?}
    | W(5) Útil(BUTTON) => found=UTIL
^ TS009 | TS101 | found={called_here}; near= | Señal(1,440) => found=SEÑAL
^ TS009 | TS101 again | found={said_first} | Olá => found=OLA
^ TS009 | = | right={cased} | F(2, TAMAÑO) => right=TAMANO
"""
