"""The rows of suggestions: what is told of words that no repair reads surely.

`SUGGESTIONS` has these columns, and the first row that holds is told:

    pattern | code | values | example => one of the values

A pattern is one of `rows`. Its first token is a whole instruction, with its brackets and its UNTIL;
the others are the words after it. Classes of the instruction, beside its word: @cmd (of the
language), @did (a DEF), @more (others stand before it on its line), @later (others stand before
it), @outer (in no block), @move, @clock (its first value is its time), @asked (has its UNTIL) and
@unasked (may get one). Words without an instruction have @none there, also @after where one stands
before them, @opening where they are the first of several lines, @last where they end the text, and
@unbegun in a text without `SI|`. Classes of the words: @number (in words, too), @often (a number
that says how often), @percent (one that says a power), @in_s (a unit of time), @other (the other
way), @paced (another pace than its power), @told (says nothing that the instruction does not),
@quote, @mark (what is written below a line that is meant again), @dots, @ask (a word of the
language that asks) and @noBUTTON (a word for BUTTON, which the kit lacks), @call and @order (of the
language: with values, or without). What `s` captures is pointed at. `h` is a header: the rest is
read with what is asked as its question, else with TRUE.

Values are texts with gaps. A gap is a capture, or a function in `suggestions`; a row with a gap
that cannot be filled does not hold, unless `?` stands after its name. `⟨less¦more⟩` makes a row of
each, and a row goes on in lines that are indented, as in `rows`. Rows are sorted by what is asked
for.
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
# what stands for what is above it, and for what follows
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
# notes
^ @none this @word @word+ $
    | TS073 | fix=// {said}
    | this makes it turn to the light => fix=// this makes it turn to the light
^ @none TSC @any* $ | TS073 | command={said}; words= | SI|F(1, 80)⏎tsc upload => command=tsc upload
# how often, before what is repeated, and a loop behind it
^ @none 1|@one times :? $ | TS062 | found={words}; line={said} | 1 vez:⏎S => line=1 vez
^ @none n=@number times :? $ | TS062 | found={words}; fix=LOOP({n}) | 4 veces:⏎S => fix=LOOP(4)
^ @last repeat (? n=@num? )? times? $
    | TS062 | found={words}; all={all?}
    | F(1, 50)⏎repetir 3 => all=LOOP(3);F(1, 50);END_LOOP
^ @opening launch $ | TS102 | found={words}; right=SI|; usage=SI|; fix= | go⏎S => right=SI|
# questions in words
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
^ @none @any* <asks> (? s='='|@word|@num+ )? <body> $
    | TS135 | word={head}
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
^ ⟨@none s=ELSEIF¦c=ELSE s=IF⟩ :? $
    | TS015 | word=ELSEIF; words=; usage=ELSEIF; example=ELSEIF({distance} < 10); bare=ELSE
    | IF(DISTANCE < 10)⏎S⏎⟨ELIF¦ELSE IF⟩⏎F(1, 60)⏎ENDIF => bare=ELSE
# what asks or calculates, alone
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
^ @none w=⟨F|B|L|R ( @num s=@in_steps|times¦BEEP|W ( @num s=@in_steps|times|@in_cm|@in_deg⟩ @any* $
    | TS053 | word={called}; name=⟨time¦seconds⟩; wanted=seconds; unit={s}; usage={usage}
    | ⟨F(3 pasos, 60)¦BEEP(3 veces)⟩ => usage=⟨F(time, power)¦BEEP(seconds, hertz)⟩
# letters for a way
^ @none s=FL|LF ( n=@num , @num ) $
    | TS101 | found={s}; near=; curve=M(30, 60);W({n});S
    | FL(1, 60) => curve=M(30, 60);W(1);S
^ @none s=A ( n=@num , m=@num ) $
    | TS101 | found=A; near=; ahead=F({n}, {m}); back=B({n}, {m})
    | A(2, 80) => ahead=F(2, 80)
# an order that is chosen, or stands for a value
^ @none RANDOM ( l=@any+ ) $
    | TS136 | fix={choice}; example={choices}
    | RANDOM(L(1, 60), S) => fix=IF(RANDOM(1, 2) = 1);L(1, 60);ELSE;S;ENDIF
^ @none @any* RANDOM ( l=@any+ ) $
    | TS136 | example={choices}
    | giro = RANDOM(L, R) => example=IF(RANDOM(1, 2) = 1); L(2, 80); ELSE; R(2, 80); ENDIF
^ @none RANDOM ( n=@num to|, m=@num ) $
    | TS042 | found=RANDOM; given={words}; number={number} = RANDOM({n}, {m})
    | RANDOM(440 a 880) => number=N = RANDOM(440, 880)
^ @none w=F|B|L|R|M|BEEP ( u=-|@num|@val+ , v=-|@num|@val+ , s=@order ) $
    | TS051 | word={s}; apart={w}({u}, {v});{next}
    | F(1, 60, S) => apart=F(1, 60);S
^ @none w=@call @any* (|, s=@order ) $
    | TS051 | word={s}; example={example}
    | F(2, R) => example=F(2, 80)
# words for nothing, and those that are no words behind it
^ c=F|B CM|@in_cm $ | TS085 | fix={by_way} | F(20, 60) cm => fix=F(20 CM, 60)
^ c=@move|W s=UN u=TIL q=@any+ $
    | TS102 | found={s} {u}; right=UNTIL; usage=UNTIL{q}
    | F(5, 60) UN TIL(DISTANCE < 30) => usage=UNTIL(DISTANCE < 30)
# how often
^ c=@more <lead> <often> <close> $
    | TS062 | found={text}; last={loop}; all={all}
    | F(1, 60); L(1, 60) x4 => last=LOOP(4);L(1, 60);END_LOOP
^ <does> <lead> <often> <close> $
    | TS062 | found={text}; fix={loop?}; once={once?}
    | F(2, 80) 3 veces => fix=LOOP(3);F(2, 80);END_LOOP
^ c=M (? n=@time )? $
    | TS085 | seconds={n}; waiting={c};W({n});S
    | M(50, 80) 2 => waiting=M(50, 80);W(2);S
^ c=@cmd (? n=@time )? $
    | TS085 | times={n}; often={loop}
    | F(2,80)(3) => often=LOOP(3);F(2,80);END_LOOP
^ ⟨<does> one then anew times¦c=@cmd count? FOREVER⟩ $
    | TS085 | endless=LOOP(FOREVER);{c};END_LOOP
    | F(1, 80) ⟨una y otra vez¦siempre⟩ => endless=LOOP(FOREVER);F(1, 80);END_LOOP
^ @none do|LOOP|make w=⟨@callw ( v=@noparen+ )¦@def⟩ @word* FOREVER|anew|over @word* $
    | TS064 | fix=LOOP(FOREVER);{w}⟨({v})¦⟩;END_LOOP
    | ⟨repeat F(1, 80)¦DEF A1;S;END_DEF⏎do A1⟩ again and again => fix=LOOP(FOREVER);⟨F(1,
    80)¦A1⟩;END_LOOP
^ <does> @any* anew @any* $
    | TS085 | again=LOOP(2);{c};END_LOOP
    | F(1, 80) again => again=LOOP(2);F(1, 80);END_LOOP
^ @none TASK s=@num :|.|-|=|)? r=@any+ $
    | TS044 | found={s}; fix=TASK;{r};END_TASK
    | TASK 1: F(5, 60) => fix=TASK;F(5, 60);END_TASK
# how long
^ c=⟨S|STOP¦M⟩ (? during? n=@number u=@in_s )? $
    | TS085 | fix={c};W({n})⟨¦;S⟩
    | ⟨S¦M(50, 50)⟩ 2 segundos => fix=⟨S¦M(50, 50)⟩;W(2)⟨¦;S⟩
^ c=@clock <lead> during|to|then|X? n=@number u=@in_s <close> t=UNTIL? q=@any* $
    | TS085 | time={n} s; longer={longer}{until?}
    | F(2,80) por 5 segundos => longer=F(5,80)
# how fast
^ c=@move ⟨<lead> @told* n=@percent @told* <close>¦A n=@num⟩ $
    | TS085 | power={paced}
    | F(2,80) ⟨al 50%¦a 50⟩ => power=F(2,50)
^ c=@move @word? @word? @paced $ | TS085 | power={c} | F(2, 80) despacio => power=F(2, 80)
# until when
^ c=@cmd s=WHEN (? q=@cond+ )? w=@start @any* $
    | TS071 | found={s}; fix=WHEN({question});{then};END_WHEN;{c}
    | F(10, 50) WHEN DISTANCE < 15 BEEP(1, 440) => fix=WHEN(DISTANCE < 15);BEEP(1,
    440);END_WHEN;F(10, 50)
^ c=@move|W s=WHILE (? q=@cond+ )? $
    | TS071 | found={s}; fix={c} UNTIL({contrary})
    | F(2, 80) while DISTANCE > 10 => fix=F(2, 80) UNTIL(DISTANCE <= 10)
^ c=@cmd s=IF (? q=@cond+ )? $
    | TS071 | found={s}; fix=IF({question});{c};ENDIF
    | S IF(DISTANCE < 10) => fix=IF(DISTANCE < 10);S;ENDIF
^ c=@move s=WHILE @word* no @word* wall $
    | TS071 | found={s}; fix={c} UNTIL({distance} < 10)
    | F(2, 80) mientras no haya pared => fix=F(2, 80) UNTIL(DISTANCE < 10)
^ c=@cmd s=when @word* no @word* wall $
    | TS071 | found={s}; fix=IF({distance} > 10);{c};ENDIF
    | S cuando no hay pared => fix=IF(DISTANCE > 10);S;ENDIF
^ c=@unasked s=UNTIL l=@word|@num|@unit+ $
    | TS102 | found={s}; right=UNTIL; usage={c} UNTIL({measured})
    | F(2, 80) hasta la pared a 30 cm => usage=F(2, 80) UNTIL(DISTANCE < 30)
^ c=@unasked h=UNTIL s=@word+ $
    | TS135 | word={head}
    | F(2, 80) hasta negro => question=LIGHT_L < 500
^ c=@unasked s=UNTIL @word+ $
    | TS102 | found={s}; right=UNTIL; usage={c} UNTIL(c)
    | F(2, 80) hasta YA => usage=F(2, 80) UNTIL(c)
# which way, and what comes next
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
# notes
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
"""
