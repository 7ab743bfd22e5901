// The sentences about lessons, in English and Spanish. Their pages and what is said of programs come
// from the lessons themselves.

/** @type {Record<string, [string, string]>} */
export const LESSON_TEXTS = {
  side_lessons: ['Lessons', 'Lecciones'],
  lessons: ['Lessons', 'Lecciones'],
  lesson: ['Lesson', 'Lección'],
  lesson_check: ['Check my program', 'Revisar mi programa'],
  lesson_end: ['End the check', 'Cancelar la revisión'],
  lesson_world: ['See its world', 'Ver su mundo'],
  lesson_page: ['What to do', 'Qué hay que hacer'],
  lesson_findings: ['What is missing', 'Lo que falta'],
  lesson_use: ['Put it into the program', 'Ponerlo en el programa'],
  lesson_used: ['It is in the program now. Yours is among My programs.',
    'Ya está en el programa. El tuyo está en Mis programas.'],
  lessons_done: ['{done} of {all} lessons done.', 'Lecciones terminadas: {done} de {all}.'],
  lessons_coming: ['Loading the lessons…', 'Cargando las lecciones…'],
  lessons_unreachable: ['The lessons did not load. Check the connection, then press Lessons again.',
    'Las lecciones no se cargaron. Revisa la conexión y pulsa Lecciones otra vez.'],
  lesson_checking: ['World {seed} of {worlds}: the robot is trying it…', 'Mundo {seed} de {worlds}: el robot lo está probando…'],
  lesson_passed: ['Done! The task of lesson {number} is solved.', '¡Listo! La tarea de la lección {number} está resuelta.'],
  lesson_passed_worlds: ['Done! The task of lesson {number} is solved, in {worlds} worlds.',
    '¡Listo! La tarea de la lección {number} está resuelta, en {worlds} mundos.'],
  lesson_failed: ['Not yet.', 'Todavía no.'],
  lesson_failed_world: ['Not yet, in world {seed}.', 'Todavía no, en el mundo {seed}.'],
  lesson_mistakes: ['Fix the mistakes first; nothing was tried.', 'Primero corrige los errores; no se probó nada.'],
  lesson_ended: ['You ended the check. There is no result.', 'Cancelaste la revisión. No hay resultado.'],
  lesson_is_done: ['done', 'terminada'],
  world_of_lesson: ['Lesson {number}', 'Lección {number}'],
  world_of_lessons: ['Lesson {number}, world {seed}', 'Lección {number}, mundo {seed}'],
};
