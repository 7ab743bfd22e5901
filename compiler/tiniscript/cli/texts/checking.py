"""What `tsc check` and `tsc lesson` say of programs, in English and Spanish.

The sentences about a run of a lesson are in `lessons/sentences.py`.
"""

from __future__ import annotations

# fmt: off
CHECK_TEXTS: dict[str, tuple[str, str]] = {
    # key: (English, Spanish)
    "no_programs": (
        "tsc: {file} has no program in it. Their names end in .ts or .tini. Try:  tsc check prog.ts",
        "tsc: en {file} no hay ningún programa. Los nombres de los programas terminan en .ts o .tini. Prueba:  tsc check prog.ts",
    ),
    "checked_right": ("{file}: no mistakes", "{file}: sin errores"),
    "checked_wrong": (
        "{file}: line {line}: {said}   [{code}]",
        "{file}: línea {line}: {said}   [{code}]",
    ),
    "checked_unread": ("{file}: {why}", "{file}: {why}"),
    "program_column": ("program", "programa"),
    "mistakes_column": ("mistakes", "errores"),
    "warnings_column": ("warnings", "avisos"),
    "repaired_column": ("repaired", "corregidos"),
    "first_column": ("first", "primero"),
    "unread": ("not read", "no se leyó"),
    "all_row": ("programs: {n}, without mistakes: {right}", "programas: {n}, sin errores: {right}"),
    "repaired_one": ("{file}: 1 mistake is repaired.", "{file}: 1 error corregido."),
    "repaired": ("{file}: {n} mistakes are repaired.", "{file}: {n} errores corregidos."),
    "would_repair_one": (
        "{file}: 1 mistake can be repaired. Try:  tsc check --fix",
        "{file}: se puede corregir 1 error. Prueba:  tsc check --fix",
    ),
    "would_repair": (
        "{file}: {n} mistakes can be repaired. Try:  tsc check --fix",
        "{file}: se pueden corregir {n} errores. Prueba:  tsc check --fix",
    ),
    "not_repaired": (
        "The rest you have to fix yourself, since it can mean several things:",
        "Lo que queda lo corriges tú, porque puede querer decir varias cosas:",
    ),
    "nothing_repaired": (
        "{file}: there is nothing here that tsc can safely repair.",
        "{file}: aquí no hay nada seguro que corregir.",
    ),
    "no_table": (
        "tsc: --csv is for several programs or a folder. Try:  tsc check FOLDER --csv table.csv",
        "tsc: --csv es para varios programas o una carpeta. Prueba:  tsc check CARPETA --csv tabla.csv",
    ),
    # lessons
    # wrong use
    "lesson_action": ("tsc: lesson takes {known}, not {found}. Try:  tsc lesson show 1",
                      "tsc: lesson acepta {known}, no {found}. Prueba:  tsc lesson show 1"),
    "lesson_which": ("tsc: which lesson? Give its number, such as:  tsc lesson {action} 1   The list:  tsc lesson",
                     "tsc: ¿qué lección? Indica su número, por ejemplo:  tsc lesson {action} 1   La lista:  tsc lesson"),
    "lesson_only": ("tsc: {option} does not go with tsc lesson{action}. Leave it out.",
                    "tsc: {option} no va con tsc lesson{action}. Quítalo."),
    "lesson_no_program": ("tsc: which program? Give a file or a folder:  tsc lesson check {number} prog.ts",
                          "tsc: ¿qué programa? Indica un archivo o una carpeta:  tsc lesson check {number} prog.ts"),
    "lesson_where": ("tsc: where should the page go? Try:  tsc lesson sheet {number} -o sheet.html",
                     "tsc: ¿a dónde va la hoja? Prueba:  tsc lesson sheet {number} -o hoja.html"),
    "lesson_refused": ("tsc: the lesson {file} cannot be used:\n{reasons}",
                       "tsc: la lección {file} no se puede usar:\n{reasons}"),
    "lesson_world": ("tsc: in world {seed} of the lesson {file} the robot does not fit:\n{reasons}",
                     "tsc: en el mundo {seed} de la lección {file} el robot no cabe:\n{reasons}"),
    "lesson_empty": ("tsc: the folder {file} has no programs. Their names end in .ts, or in .txt if a program is inside.",
                     "tsc: en la carpeta {file} no hay ningún programa. Los nombres de los programas terminan en .ts, o en .txt si el archivo tiene un programa."),
    "lesson_notes": ("Not checked, since they look like notes: {files}. To check one anyway:  tsc lesson check {number} FILE",
                     "Sin revisar, porque parecen apuntes: {files}. Para revisar uno de todos modos:  tsc lesson check {number} ARCHIVO"),
    "lesson_many": ("tsc: the folder {file} has more than {most} programs. Check some of them at a time.",
                    "tsc: la carpeta {file} tiene más de {most} programas. Revísalos por partes."),
    "lesson_folder": ("tsc: the folder {file} cannot be read: {why}. Copy it to another place and try again.",
                      "tsc: no se puede leer la carpeta {file}: {why}. Cópiala a otro lugar y prueba otra vez."),
    "lesson_one_picture": ("tsc: --plot draws one program. Give a file in the folder {file}.",
                           "tsc: --plot dibuja un solo programa. Indica un archivo de la carpeta {file}."),
    # what it says
    "lesson_title": ("{number}  {title}   ({robot})", "{number}  {title}   ({robot})"),
    "lesson_hint": ("The page of a lesson:  tsc lesson show 1", "La página de una lección:  tsc lesson show 1"),
    "lesson_sheet": ("{file}: {title}. Open it in a browser, or print it.",
                     "{file}: {title}. Ábrela en un navegador, o imprímela."),
    "lesson_answers": ("Answers", "Respuestas"),
    "lesson_wrong": ("What often goes wrong, and what tsc says", "Lo que suele salir mal, y lo que dice tsc"),
    "lesson_passed": ("{file}: done! The task of lesson {number} is solved.",
                      "{file}: ¡listo! La tarea de la lección {number} está resuelta."),
    "lesson_passed_worlds": ("{file}: done! The task of lesson {number} is solved, in {worlds} worlds.",
                             "{file}: ¡listo! La tarea de la lección {number} está resuelta, en {worlds} mundos."),
    "lesson_failed": ("{file}: not yet.", "{file}: todavía no."),
    "lesson_failed_world": ("{file}: not yet, in world {seed}.", "{file}: todavía no, en el mundo {seed}."),
    "lesson_finding": ("- {said}", "- {said}"),
    "lesson_again": ("This world again:  tsc lesson check {number} {file} --seed {seed}",
                     "Otra vez ese mundo:  tsc lesson check {number} {file} --seed {seed}"),
    "lesson_mistakes": ("{file}: repair the mistakes first; nothing was tried.",
                        "{file}: primero corrige los errores; no se probó nada."),
    "lesson_try": ("Try:  {fix}", "Prueba:  {fix}"),
    "lesson_picture": ("Picture: {file}", "Imagen: {file}"),
    "lesson_count": ("Lesson {number} done: {passed} of {all}.",
                     "Tarea de la lección {number} resuelta: {passed} de {all}."),
    "verdict_passed": ("done", "listo"),
    "verdict_failed": ("not yet", "todavía no"),
    "verdict_mistakes": ("mistakes", "errores"),
    "verdict_unreadable": ("unreadable", "ilegible"),
    "verdict_no_program": ("no program", "no es un programa"),
}
