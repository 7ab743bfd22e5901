"""What `tsc check` says of several programs, and of repairs, in English and Spanish."""

from __future__ import annotations

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
        "The rest is yours to repair, since it can mean several things:",
        "Lo que queda lo corriges tú, porque puede querer decir varias cosas:",
    ),
    "nothing_repaired": (
        "{file}: nothing is sure enough to be repaired here.",
        "{file}: aquí no hay nada seguro que corregir.",
    ),
    "no_table": (
        "tsc: --csv is for several programs or a folder. Try:  tsc check FOLDER --csv table.csv",
        "tsc: --csv es para varios programas o una carpeta. Prueba:  tsc check CARPETA --csv tabla.csv",
    ),
}
