"""What there is to say of a finding: what the robot did, and what to try, in two languages.

Knows every key of `judging`. Does not know when one applies.
"""

from __future__ import annotations

from tiniscript.lessons.findings import Finding
from tiniscript.source import printable
from tiniscript.words import WORDS

# fmt: off
SENTENCES: dict[str, tuple[str, str]] = {
    # the run as a whole
    "asks": ("The program begins with PING, so the robot does nothing. Begin with SI or with nothing.",
             "El programa empieza con PING, así que el robot no hace nada. Empieza con SI o sin nada."),
    "busy": ("In {seconds} s the robot did more than 200000 things without a rest. Put W(0.05) into the loop.",
             "En {seconds} s el robot hizo más de 200000 cosas sin descanso. Pon W(0.05) dentro del bucle."),
    "long": ("After {seconds} s the robot was still moving when the time was over. Times are seconds: look for one that is too large, or for a loop without an end.",
             "A los {seconds} s el robot todavía se movía y el tiempo se acabó. Los tiempos son segundos: busca uno demasiado grande, o un bucle sin final."),
    "still/question": ("The robot did not move. Is the question of {word} {truth} from the start? See what the robot reads: {show}",
                       "El robot no se movió. ¿La pregunta de {word} da {truth} desde el inicio? Mira qué lee el robot: {show}"),
    "turned/question": ("The robot only turned on the spot. Is the question of {word} {truth} from the start? See what the robot reads: {show}",
                        "El robot solo giró en su sitio. ¿La pregunta de {word} da {truth} desde el inicio? Mira qué lee el robot: {show}"),
    "still/ever": ("The robot did not move. Does the question of {word} ever become {truth}? See what the robot reads: {show}",
                   "El robot no se movió. ¿La pregunta de {word} llega a dar {truth}? Mira qué lee el robot: {show}"),
    "turned/ever": ("The robot only turned on the spot. Does the question of {word} ever become {truth}? See what the robot reads: {show}",
                    "El robot solo giró en su sitio. ¿La pregunta de {word} llega a dar {truth}? Mira qué lee el robot: {show}"),
    "unreached": ("The program has {word}, but the robot never gets there. Look at what comes before: a question, or a loop without an end.",
                  "El programa tiene {word}, pero el robot nunca llega ahí. Mira lo que está antes: una pregunta o un bucle sin final."),
    "still": ("The robot did not move. Give it a move with time and power: F(2, 80)",
              "El robot no se movió. Dale un movimiento con tiempo y potencia: F(2, 80)"),
    "still/brief": ("M sets the power, and the program goes on at once: here it ended before the robot could move. Add a wait after M: M(60, 60); W(2); S",
                    "M da la potencia y el programa sigue de inmediato: aquí terminó antes de que el robot pudiera moverse. Haz que espere después de M: M(60, 60); W(2); S"),
    "fault/OVERFLOW": ("After {seconds} s a number got too large and the program stopped. Use smaller numbers.",
                       "A los {seconds} s un número se hizo demasiado grande y el programa se detuvo. Usa números más pequeños."),
    "fault/DIVIDE_BY_ZERO": ("After {seconds} s something was divided by 0 and the program stopped. Ask with IF before you divide.",
                             "A los {seconds} s algo se dividió entre 0 y el programa se detuvo. Pregunta con IF antes de dividir."),
    "fault/NO_POWER": ("After {seconds} s a move had power 0 and a way to go, and the program stopped. Use more power.",
                       "A los {seconds} s un movimiento tenía potencia 0 y camino por recorrer, y el programa se detuvo. Usa más potencia."),
    "fault/STUCK": ("After {seconds} s a wheel did not turn, and the program stopped. Keep away from what is in the way.",
                    "A los {seconds} s una rueda no giraba, y el programa se detuvo. Aléjate de lo que estorba."),
    "fault": ("After {seconds} s the robot ended the program ({fault}). Look at what it did just before.",
              "A los {seconds} s el robot terminó el programa ({fault}). Mira qué hizo justo antes."),
    # places
    "ends_in/short": ("The robot stopped {cm} cm before the middle of {place}. Make it go further.",
                      "El robot se quedó {cm} cm antes del centro {of_place}. Haz que avance más."),
    "ends_in/far": ("The robot went {cm} cm past the middle of {place}. Make it stop earlier.",
                    "El robot se pasó {cm} cm del centro {of_place}. Haz que pare antes."),
    "ends_in/turned": ("The robot only turned on the spot. Forward is F: F(2, 80)",
                       "El robot solo giró en su sitio. Adelante es F: F(2, 80)"),
    "ends_in/away": ("At the end the robot was {cm} cm from {place}. Look at which way it went, and change one thing only.",
                     "Al final el robot quedó a {cm} cm {of_place}. Mira por dónde fue y cambia una sola cosa."),
    "ends_in/left": ("The robot was at {place}, and left it: at the end it was {cm} cm away. Let it stay there.",
                     "El robot estuvo en {place} y se fue: al final quedó a {cm} cm. Haz que se quede ahí."),
    "ends_in/gone": ("The robot did not come back: at the end it was {cm} cm from {place}. Add the way back.",
                     "El robot no volvió: al final quedó a {cm} cm {of_place}. Agrega el camino de vuelta."),
    "reaches/one": ("The closest the robot came to {place} was {cm} cm; the task asks for {within} cm or less. Look at where it went.",
                    "Lo más cerca que el robot estuvo {of_place} fue a {cm} cm; la tarea pide {within} cm o menos. Mira por dónde fue."),
    "reaches/short": ("The closest the robot came to {place} was {cm} cm; the task asks for {within} cm or less. Make it go further.",
                      "Lo más cerca que el robot estuvo {of_place} fue a {cm} cm; la tarea pide {within} cm o menos. Haz que avance más."),
    "reaches/turned": ("The robot only turned on the spot. Forward is F: F(2, 80)",
                       "El robot solo giró en su sitio. Adelante es F: F(2, 80)"),
    "reaches/over": ("The program ended when {place} was still {cm} cm away. Let it go on for longer.",
                     "El programa terminó cuando al robot le faltaban {cm} cm para llegar {to_place}. Haz que siga más tiempo."),
    "reaches/several": ("The robot did not get to {place} {number} of {all}. Look at the move before it.",
                        "El robot no llegó {to_place} {number} de {all}. Mira el movimiento anterior."),
    "reaches/ended": ("The program ended before the robot got to {place} {number} of {all}. Let it go on, or repeat more often.",
                      "El programa terminó antes de que el robot llegara {to_place} {number} de {all}. Haz que siga o que repita más veces."),
    "reaches/time": ("In {seconds} s the robot did not get to {place} {number} of {all}. Look at the move before it, and at how fast it goes.",
                     "En {seconds} s el robot no llegó {to_place} {number} de {all}. Mira el movimiento anterior y qué tan rápido va."),
    "reaches/past": ("The robot went {cm} cm past {place} {number} before it stopped or turned. Make that stretch shorter.",
                     "El robot se pasó {cm} cm {of_place} {number} antes de parar o girar. Acorta ese tramo."),
    "reaches/slow": ("After {seconds} s the time was over, and the robot was still on its way, {cm} cm from {place}. Make it go faster.",
                     "A los {seconds} s se acabó el tiempo y el robot todavía iba en camino, a {cm} cm {of_place}. Haz que vaya más rápido."),
    "reaches/late": ("The robot was at {place} after {seconds} s; it has {limit} s. Make it faster, or its path shorter.",
                     "El robot llegó {to_place} a los {seconds} s y tiene {limit} s. Hazlo más rápido o acorta el camino."),
    "reaches/around": ("The robot drove {cm} cm to {place}; {limit} cm will do. Make it go there more directly.",
                       "El robot recorrió {cm} cm hasta llegar {to_place}; con {limit} cm alcanza. Haz que vaya más directo."),
    "stays_in": ("After {seconds} s the robot left {place}. Look at what it does just before.",
                 "A los {seconds} s el robot salió {of_place}. Mira qué hace justo antes."),
    "stands_before/far": ("The robot stood {cm} cm before the obstacle; the task asks for {low} to {high} cm. Make it go closer.",
                          "El robot quedó a {cm} cm del obstáculo; la tarea pide de {low} a {high} cm. Haz que se acerque más."),
    "stands_before/near": ("The robot stood {cm} cm before the obstacle; the task asks for {low} to {high} cm. Make it stop earlier.",
                           "El robot quedó a {cm} cm del obstáculo; la tarea pide de {low} a {high} cm. Haz que pare antes."),
    "stands_before/nothing": ("At the end there was nothing in front of the robot. Make it face the obstacle.",
                              "Al final no había nada delante del robot. Haz que mire hacia el obstáculo."),
    "stands_before/other": ("At the end the robot was not in front of {place}. Make it drive there, facing it.",
                            "Al final el robot no estaba frente {to_place}. Haz que avance hacia ahí y quede de frente."),
    "faces/left": ("At the end the robot looks {degrees} degrees too far to the left. Turn it less to the left, or more to the right.",
                   "Al final el robot mira {degrees} grados demasiado a la izquierda. Gíralo menos a la izquierda o más a la derecha."),
    "faces/right": ("At the end the robot looks {degrees} degrees too far to the right. Turn it less to the right, or more to the left.",
                    "Al final el robot mira {degrees} grados demasiado a la derecha. Gíralo menos a la derecha o más a la izquierda."),
    "faces/behind": ("At the end the robot looks the opposite way. Check which way it turns, and whether it goes F or B.",
                     "Al final el robot mira hacia el lado contrario. Revisa hacia qué lado gira y si va con F o con B."),
    # ways
    "touches/wall": ("The robot touched the wall after {seconds} s. Look at what it does just before.",
                     "El robot tocó la pared a los {seconds} s. Mira qué hace justo antes."),
    "touches/box": ("The robot touched a box after {seconds} s. Look at what it does just before.",
                    "El robot tocó una caja a los {seconds} s. Mira qué hace justo antes."),
    "touches/border": ("The robot touched the edge of the floor after {seconds} s. Look at what it does just before.",
                       "El robot tocó el borde de la pista a los {seconds} s. Mira qué hace justo antes."),
    "follows/off": ("After {seconds} s the robot left the black line; it had followed {cm} cm of {least}. Go slower, or turn harder.",
                    "A los {seconds} s el robot dejó la línea negra; había seguido {cm} cm de {least}. Ve más lento o gira con más fuerza."),
    "follows/early": ("After {seconds} s the robot left the black line. Look at which way it turns when one of its sensors sees black.",
                      "A los {seconds} s el robot dejó la línea negra. Mira hacia qué lado gira cuando uno de sus sensores ve negro."),
    "follows/short": ("The robot followed {cm} cm of the black line; the task asks for {least} cm. Make it go on.",
                      "El robot siguió {cm} cm de la línea negra; la tarea pide {least} cm. Haz que continúe."),
    "follows/slow": ("In {seconds} s the robot followed only {cm} cm of the black line; the task asks for {least} cm. Make it drive faster, and turn less.",
                     "En {seconds} s el robot siguió solo {cm} cm de la línea negra; la tarea pide {least} cm. Haz que avance más rápido y gire menos."),
    "drives/short": ("The robot drove {cm} cm; the task asks for at least {limit} cm. Make it drive more.",
                     "El robot recorrió {cm} cm; la tarea pide al menos {limit} cm. Haz que avance más."),
    "drives/long": ("The robot drove {cm} cm; the task allows {limit} cm. Look for a shorter path.",
                    "El robot recorrió {cm} cm; la tarea permite {limit} cm. Busca un camino más corto."),
    # times
    "pauses/none": ("The robot did not wait between its moves. Put W({least}) between two moves.",
                    "El robot no esperó entre sus movimientos. Pon W({least}) entre dos movimientos."),
    "pauses/short": ("The robot waited {seconds} s; the task asks for {least} s. Put W({least}) between two moves.",
                     "El robot esperó {seconds} s; la tarea pide {least} s. Pon W({least}) entre dos movimientos."),
    "pauses/several": ("The robot waited {least} s between its moves {found} of {times} times. Put W({least}) there.",
                       "El robot esperó {least} s entre sus movimientos {found} de {times} veces. Pon ahí W({least})."),
    "pauses/place": ("The robot waited {seconds} s, but {cm} cm from {place}; {within} cm or less is right. Make it wait there.",
                     "El robot esperó {seconds} s, pero a {cm} cm {of_place}; tiene que ser a {within} cm o menos. Haz que espere ahí."),
    "pauses/places": ("The robot did not wait {least} s at {place} {number}: its nearest wait was {cm} cm away; {within} cm or less is right. Make it wait there.",
                      "El robot no esperó {least} s en {place} {number}: lo más cerca que esperó fue a {cm} cm; tiene que ser a {within} cm o menos. Haz que espere ahí."),
    "order//moves": ("The robot did not move. Give it a move: F(2, 80)", "El robot no se movió. Dale un movimiento: F(2, 80)"),
    "order//stops": ("The robot never stopped. Make it stop: S", "El robot nunca se detuvo. Haz que pare: S"),
    "order//beeps": ("The robot did not beep. Give it a sound: BEEP(0.2, 440)", "El robot no sonó. Dale un sonido: BEEP(0.2, 440)"),
    "order//shows": ("The robot showed nothing. Show a value: SHOW(DISTANCE)", "El robot no mostró nada. Muestra un valor: SHOW(DISTANCE)"),
    "order": ("After it {before}, the robot should {then}, but it does not. Check the order of the lines, or repeat them.",
              "Después de {before}, el robot tendría que {then}, pero no lo hace. Revisa el orden de las líneas o repítelas."),
    "order_again": ("After it {before} {times} times, the robot should {then} once more, but it does not. Repeat those lines with LOOP, or add what is missing.",
                    "Después de {before} {times} veces, el robot tendría que {then} otra vez, pero no lo hace. Repite esas líneas con LOOP o agrega lo que falta."),
    "ends": ("After {seconds} s the program was still running. It must end by itself: give its loop an end.",
             "A los {seconds} s el programa todavía seguía. Tiene que terminar solo: ponle un final al bucle."),
    # what it says
    "shows/nothing": ("The robot showed nothing. Write what it should show: {show}",
                      "El robot no mostró nada. Escribe qué debe mostrar: {show}"),
    "shows/few": ("The robot showed {found} of {times} values. Put SHOW where the program passes more often.",
                  "El robot mostró {found} de {times} valores. Pon SHOW donde pase más veces."),
    "shows/sensor": ("The robot showed {value}, but {what} was about {wanted} then. Make it measure and show: {show}",
                     "El robot mostró {value}, pero {what} era más o menos {wanted}. Haz que mida y muestre: {show}"),
    "shows/time": ("The robot showed {value}, but it was on its way for {wanted} s. Make the robot count: {show}",
                   "El robot mostró {value}, pero llevaba {wanted} s en camino. Haz que el robot cuente: {show}"),
    "shows/value": ("The robot showed {value}; {wanted} is right. Check how the program calculates it.",
                    "El robot mostró {value}; lo correcto es {wanted}. Revisa cómo lo calcula el programa."),
    "beeps/none": ("The robot did not beep. Give it a sound: BEEP(0.2, 440)",
                   "El robot no sonó. Dale un sonido: BEEP(0.2, 440)"),
    "beeps/few": ("The robot beeped {found} of {times} times. Add the sounds that are missing.",
                  "El robot sonó {found} de {times} veces. Agrega los sonidos que faltan."),
    "beeps/pitches": ("The robot beeped at {different} of {pitches} pitches. Change the second number of a BEEP: BEEP(0.2, 660)",
                      "El robot sonó con {different} de {pitches} tonos. Cambia el segundo número de un BEEP: BEEP(0.2, 660)"),
    "beeps/place": ("The robot beeped {cm} cm from {place}; {within} cm or less is right. Put BEEP after the move that ends there.",
                    "El robot sonó a {cm} cm {of_place}; tiene que ser a {within} cm o menos. Pon BEEP después del movimiento que termina ahí."),
    "beeps/places": ("The robot did not beep at {place} {number}: its nearest beep was {cm} cm away; {within} cm or less is right. Put BEEP after the move that ends there.",
                     "El robot no sonó en {place} {number}: lo más cerca que sonó fue a {cm} cm; tiene que ser a {within} cm o menos. Pon BEEP después del movimiento que termina ahí."),
    "blinks/none": ("{what} never went on. Switch it on and off: {what}(TRUE); W(0.2); {what}(FALSE); W(0.2)",
                    "{what} nunca se encendió. Enciéndelo y apágalo: {what}(TRUE); W(0.2); {what}(FALSE); W(0.2)"),
    "blinks/few": ("{what} went on {found} of {times} times while the robot moved. Let a TASK blink: it goes on beside the moves.",
                   "{what} se encendió {found} de {times} veces mientras el robot se movía. Haz que parpadee un TASK: sigue a la vez que los movimientos."),
    # the text
    "uses/none": ("The program does not use {word}. It helps here: {example}",
                  "El programa no usa {word}. Aquí ayuda: {example}"),
    "uses/few": ("The program uses {word} {found} of {times} times. It helps here once more: {example}",
                 "El programa usa {word} {found} de {times} veces. Aquí ayuda otra vez: {example}"),
    "uses/uncalled": ("The program teaches the word {name} and never calls it. Write {name} on a line of its own.",
                      "El programa enseña la palabra {name} y nunca la llama. Escribe {name} en una línea propia."),
    "uses/idle": ("The LOOP of the program repeats nothing. Put what you wrote several times between LOOP and END_LOOP.",
                  "El LOOP del programa no repite nada. Pon entre LOOP y END_LOOP lo que se repite."),
    "uses/unasked": ("The UNTIL of the program asks about nothing that changes. Ask about a sensor: UNTIL({question})",
                     "El UNTIL del programa no pregunta nada que cambie. Pregunta por un sensor: UNTIL({question})"),
    "needs/LOOP": ("The robot does the task just as well when each LOOP is done only once. Let LOOP repeat what you wrote several times.",
                   "El robot cumple la tarea igual de bien si cada LOOP se hace una sola vez. Haz que LOOP repita lo que el programa tiene varias veces."),
    "needs/DEF": ("The robot does the task just as well without the word {name}. Let your own word do a part of the task.",
                  "El robot cumple la tarea igual de bien sin la palabra {name}. Haz que tu palabra haga una parte de la tarea."),
    "needs/WHEN": ("The robot does the task just as well without the WHEN. Let WHEN do a part of the task.",
                   "El robot cumple la tarea igual de bien sin el WHEN. Haz que WHEN haga una parte de la tarea."),
    "needs/TASK": ("The robot does the task just as well without the TASK. Let TASK do a part of the task.",
                   "El robot cumple la tarea igual de bien sin el TASK. Haz que TASK haga una parte de la tarea."),
    "moves/ahead": ("The program has {found} moves that go ahead or back; {most} will do. Write that stretch once, and let LOOP repeat it.",
                    "El programa tiene {found} movimientos hacia adelante o atrás; con {most} alcanza. Escribe el tramo una vez y haz que LOOP lo repita."),
    "moves": ("The program has {found} moves; {most} will do. Use a LOOP or a DEF for what you wrote twice.",
              "El programa tiene {found} movimientos; con {most} alcanza. Usa un LOOP o un DEF para lo que está dos veces."),
}
# what happens: as it stands behind "after", and behind "should"
EVENTS = {
    "moves": (("moves", "move"), ("moverse", "moverse")),
    "stops": (("stops", "stop"), ("parar", "parar")),
    "beeps": (("beeps", "beep"), ("sonar", "sonar")),
    "shows": (("shows a value", "show a value"), ("mostrar un valor", "mostrar un valor")),
}
# of words whose row in the table of words has no example, or one for another robot
EXAMPLES = {
    "UNTIL": "F(FOREVER, 60) UNTIL({question})", "IF": "IF({question}) ... ENDIF",
    "WHILE": "WHILE({question}) ... END_WHILE", "LOOP": "LOOP(3) ... END_LOOP",
    "ELSE": "IF({question}) ... ELSE ... ENDIF", "DEF": "DEF STEP ... END_DEF",
    "WHEN": "WHEN({question}) ... END_WHEN", "TASK": "TASK ... END_TASK",
    "CM": "F(20 CM, 60)", "DEG": "R(90 DEG, 60)",
}
# fmt: on


def sentence(finding: Finding, language: str) -> str:
    """Return what is said of a finding, in en or es."""
    key = finding.key
    if key not in SENTENCES:
        key = key.partition("/")[0]
    if key == "order" and finding.values["times"] != "1":
        key = "order_again"
    k = language == "es"
    place = finding.labels[language] if finding.labels else ""
    what = finding.values.get("what") or "DISTANCE"
    values = {
        **{name: printable(value) for name, value in finding.values.items()},
        "place": place,
        "of_place": _joined("de", place),
        "to_place": _joined("a", place),
        "show": f"SHOW({what})",
        "example": _example(finding.values.get("word", ""), finding.values.get("question", "")),
        "before": _event(finding, 1, k),
        "then": _event(finding, 2, k),
    }
    return SENTENCES[key][k].format(**values)


def _event(finding: Finding, number: int, k: int) -> str:
    """Return an event of the key `order/before/then` in words."""
    parts = [*finding.key.split("/"), "", ""]
    return EVENTS[parts[number]][k][number - 1] if parts[number] in EVENTS else ""


def _joined(preposition: str, label: str) -> str:
    """Return a Spanish label behind `de` or `a`, which become one word with `el`."""
    if label.startswith("el "):
        return f"{preposition}l {label[3:]}" if preposition == "de" else f"al {label[3:]}"
    return f"{preposition} {label}"


def _example(word: str, question: str) -> str:
    if word in EXAMPLES:
        return EXAMPLES[word].format(question=question)
    return WORDS[word].example if word in WORDS else word
