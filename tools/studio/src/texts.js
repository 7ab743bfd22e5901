// Every sentence of the page, in English and Spanish. What is said of programs comes from the
// compiler.

import { CLASS_TEXTS } from './class/class_texts.js';
import { LESSON_TEXTS } from './lesson_texts.js';
import { ROBOT_TEXTS } from './robot/robot_texts.js';
import { WORLD_TEXTS } from './world_texts.js';

/** @typedef {'en' | 'es'} Language */

/** @type {Record<string, [string, string]>} */
export const TEXTS = {
  ...LESSON_TEXTS,
  ...ROBOT_TEXTS,
  ...CLASS_TEXTS,
  ...WORLD_TEXTS,
  title: ['TiniScript Studio', 'TiniScript Studio'],
  home: ['To the start', 'Al inicio'],
  start_title: ['Press a picture: the robot does it.', 'Pulsa un dibujo y el robot lo hace.'],
  begin_dance: ['Dance', 'Baile'],
  begin_square: ['Square', 'Cuadrado'],
  begin_obstacle: ['Obstacle', 'Obstáculo'],
  begin_line: ['Line', 'Línea'],
  begin_light: ['Light', 'Luz'],
  begin_music: ['Music', 'Música'],
  half_robot: ['Robot', 'Robot'],
  bar: ['Run and stop', 'Probar y parar'],
  start_write: ['Write a program', 'Escribir un programa'],
  start_lessons: ['Lessons', 'Lecciones'],
  start_robot: ['Connect a robot', 'Conectar un robot'],
  robot: ['Robot', 'Robot'],
  theme: ['Dark', 'Oscuro'],
  language: ['Language', 'Idioma'],
  open: ['Open…', 'Abrir…'],
  save: ['Save', 'Guardar'],
  my_programs: ['My programs', 'Mis programas'],
  program_name: ['Name of this program', 'Nombre de este programa'],
  public: ['Public address of this page, if it has one', 'Dirección pública de esta página, si tiene una'],
  public_wrong: ['An address begins with https:// or http://.', 'Una dirección empieza con https:// o http://.'],
  new: ['New program', 'Programa nuevo'],
  close: ['Close', 'Cerrar'],
  share: ['Share this program', 'Compartir este programa'],
  share_link: ['As a link', 'Como enlace'],
  share_line: ['As a line of text', 'Como línea de texto'],
  share_picture: ['Picture of the blocks', 'Imagen de los bloques'],
  share_picture_not: ['There is no picture of these blocks: the program is empty or too long for blocks.',
    'No hay imagen de estos bloques: el programa está vacío o es muy largo para bloques.'],
  share_link_anywhere: ['Whoever opens it sees the program in this page, at this address. It does not run by itself.',
    'Quien lo abra verá el programa en esta misma página. No se ejecuta solo.'],
  share_link_network: ['Whoever opens it in this network sees the program in this page, while the page is there. It does not run by itself.',
    'Quien lo abra en esta red verá el programa en esta misma página, mientras la página siga ahí. No se ejecuta solo.'],
  share_link_here: ['This link opens on this computer only. For elsewhere, send the line of text, or share from a page with an address of its own.',
    'Este enlace se abre solo en esta computadora. Para otro lugar, envía la línea de texto, o comparte desde una página con dirección propia.'],
  share_line_told: ['A phone with a Bluetooth terminal sends this line to the robot. The sign ~ and what follows let the robot check it.',
    'Un teléfono con una terminal Bluetooth envía esta línea al robot. Con el signo ~ y lo que sigue, el robot la comprueba.'],
  shared: ['What you share', 'Lo que compartes'],
  shared_picture: ['The same as a QR code, for the camera of a phone', 'Lo mismo como código QR, para la cámara de un teléfono'],
  no_picture: ['It is too long for a QR code: copy it.', 'Es muy largo para un código QR: cópialo.'],
  link_too_long: ['The program is too long for a link. Save it, and send the file.',
    'El programa es muy largo para un enlace. Guárdalo y envía el archivo.'],
  link_opened: ['This program came with a link. Read it before you run it. Yours is among My programs.',
    'Este programa llegó en un enlace. Léelo antes de probarlo. El tuyo está en Mis programas.'],
  link_wrong: ['The link is incomplete: ask for it again. Your program is still here.',
    'El enlace no está completo: pídelo otra vez. Tu programa sigue aquí.'],
  copy: ['Copy', 'Copiar'],
  copied: ['Copied.', 'Copiado.'],
  copy_by_hand: ['It is selected: copy it with Ctrl+C.', 'Está seleccionado: cópialo con Ctrl+C.'],
  earlier: ['Earlier programs on this device', 'Programas anteriores en este dispositivo'],
  open_again: ['Open', 'Abrir'],
  open_again_from: ['Open the program of {time}', 'Abrir el programa de {time}'],
  opened_again: ['Opened: the program of {time}', 'Abierto: el programa de {time}'],
  editor: ['Program', 'Programa'],
  views: ['Write with', 'Escribir con'],
  view_blocks: ['Blocks', 'Bloques'],
  view_text: ['Text', 'Texto'],
  level: ['Which blocks', 'Qué bloques'],
  level_few: ['To begin', 'Para empezar'],
  level_usual: ['More blocks', 'Más bloques'],
  level_all: ['All blocks', 'Todos los bloques'],
  words: ['Show the words of the text', 'Mostrar las palabras del texto'],
  undo: ['Undo', 'Deshacer'],
  redo: ['Redo', 'Rehacer'],
  blocks: ['The program as blocks', 'El programa en bloques'],
  blocks_wait: ['The blocks wait until the text is right again. Touch them to see it as it is.',
    'Los bloques esperan a que el texto esté bien. Tócalos para verlo como está.'],
  blocks_many: ['This program is too long for blocks. Write it as text.',
    'Este programa es muy largo para bloques. Escríbelo como texto.'],
  messages: ['What the compiler says', 'Lo que dice el compilador'],
  starting: ['The compiler is starting…', 'El compilador está arrancando…'],
  right: ['The program is correct: {bytes} bytes.', 'El programa está bien: {bytes} bytes.'],
  one_loose: ['1 loose block does not run', '1 bloque suelto no se ejecuta'],
  loose: ['{count} loose blocks do not run', '{count} bloques sueltos no se ejecutan'],
  one_mistake: ['1 mistake', '1 error'],
  mistakes: ['{count} mistakes', '{count} errores'],
  one_warning: ['1 warning', '1 aviso'],
  warnings: ['{count} warnings', '{count} avisos'],
  line: ['Line {line}', 'Línea {line}'],
  try: ['Try:', 'Prueba:'],
  repair: ['Do it', 'Hacerlo'],
  repair_line: ['Do it: line {line}, {fix}', 'Hacerlo: línea {line}, {fix}'],
  more: ['… and {count} more.', '… y {count} más.'],
  simulator: ['Virtual robot', 'Robot virtual'],
  world: ['World', 'Mundo'],
  arena: ['The robot in its world, from above', 'El robot en su mundo, visto desde arriba'],
  run: ['Run', 'Probar'],
  pause: ['Pause', 'Pausa'],
  go_on: ['Go on', 'Seguir'],
  step: ['Step', 'Paso'],
  push: ['Its button', 'Su botón'],
  stop: ['STOP', 'PARAR'],
  speed: ['Speed', 'Velocidad'],
  values: ['What the robot senses', 'Lo que percibe el robot'],
  trace: ['What it has done', 'Lo que ha hecho'],
  sound: ['Sound', 'Sonido'],
  erase_ways: ['Erase the paths', 'Borrar los caminos'],
  seen: ['See', 'Ver'],
  seen_arena: ['From above', 'Desde arriba'],
  seen_plot: ['Curves', 'Curvas'],
  seen_trace: ['List', 'Lista'],
  plot: ['Its values over time', 'Sus valores en el tiempo'],
  save_trace: ['Save this list', 'Guardar esta lista'],
  trace_name: ['trace.txt', 'traza.txt'],
  of: ['{value} of {most}', '{value} de {most}'],
  time: ['Time', 'Tiempo'],
  motors: ['Motors', 'Motores'],
  bumps: ['Collisions', 'Choques'],
  robot_off: ['Press Run: the robot drives here.', 'Pulsa Probar y el robot se mueve.'],
  task: ['Take the flags in their order ({count}) without a collision: three stars.',
    'Toma las banderas en orden ({count}) sin chocar: tres estrellas.'],
  task_in_time: ['Take the flags in their order ({count}), in {seconds} s, without a collision: three stars.',
    'Toma las banderas en orden ({count}), en {seconds} s y sin chocar: tres estrellas.'],
  score_flags: ['Flags: {taken} of {of}.', 'Banderas: {taken} de {of}.'],
  score_points: ['Points: {points}.', 'Puntos: {points}.'],
  score_stars: ['Stars: {stars} of {most}.', 'Estrellas: {stars} de {most}.'],
  where_bump: ['It bumps into something.', 'Choca con algo.'],
  where_bumps: ['Collisions: {count}.', 'Choques: {count}.'],
  where_is: ['The robot is {x} cm from the left and {y} cm from the bottom, and looks {way}.',
    'El robot está a {x} cm de la izquierda y a {y} cm de abajo, y mira {way}.'],
  where_right: ['to the right', 'a la derecha'],
  where_up_right: ['up to the right', 'arriba a la derecha'],
  where_up: ['up', 'hacia arriba'],
  where_up_left: ['up to the left', 'arriba a la izquierda'],
  where_left: ['to the left', 'a la izquierda'],
  where_down_left: ['down to the left', 'abajo a la izquierda'],
  where_down: ['down', 'hacia abajo'],
  where_down_right: ['down to the right', 'abajo a la derecha'],
  robot_running: ['It is running.', 'Está en marcha.'],
  robot_waiting: ['It waits for its button.', 'Espera su botón.'],
  robot_paused: ['Paused.', 'En pausa.'],
  robot_held: ['Stopped before line {line}.', 'Se detuvo antes de la línea {line}.'],
  breakpoint: ['Stop here, or not (F9)', 'Detener aquí o no (F9)'],
  no_breakpoint: ['From line {line} on there is nothing to stop at.', 'Desde la línea {line} no hay ninguna instrucción donde detenerse.'],
  robot_ended: ['It has ended.', 'Terminó.'],
  robot_stopping: ['Stopping…', 'Deteniendo…'],
  robot_stopped: ['Stopped.', 'Detenido.'],
  robot_fault: ['Fault: {what}', 'Falla: {what}'],
  still_compiling: ['The compiler is still working…', 'El compilador sigue trabajando…'],
  press_again: ['The compiler is still working. Press again in a moment.', 'El compilador sigue trabajando. Pulsa otra vez en un momento.'],
  first_repair: ['Fix the program first.', 'Primero corrige el programa.'],
  file_name: ['program.ts', 'programa.ts'],
  opened: ['Opened: {name}', 'Abierto: {name}'],
  not_opened: ['{name} was not opened. {why}', '{name} no se abrió. {why}'],
  saved: ['Saved: {name}', 'Guardado: {name}'],
  unreadable: ['The browser cannot read it. Copy it to another folder and try again.',
    'El navegador no lo puede leer. Cópialo a otra carpeta y prueba otra vez.'],
  not_kept: ['This browser keeps nothing for this page: save your program before you leave.',
    'Este navegador no guarda nada para esta página: guarda tu programa antes de salir.'],
  kept_too_long: ['This program is too long for the browser to keep: save it before you leave.',
    'El navegador no guarda un programa tan largo: guárdalo tú antes de salir.'],
  no_compiler: ['The compiler did not start. Reload the page; your program is kept.',
    'El compilador no arrancó. Recarga la página; tu programa queda guardado.'],
  bug: ['Something went wrong in the studio. That is our mistake, not yours. Reload the page; your program is kept. ({why})',
    'Algo salió mal en el estudio. El error es nuestro, no tuyo. Recarga la página; tu programa queda guardado. ({why})'],
};

// The texts of the editor itself, as CodeMirror names them.
/** @type {Record<string, string>} */
export const EDITOR_PHRASES_ES = {
  'Control character': 'Carácter de control',
  Completions: 'Palabras posibles',
  Diagnostics: 'Mensajes',
  'No diagnostics': 'Sin mensajes',
  close: 'cerrar',
  'Fold line': 'Plegar',
  'Unfold line': 'Desplegar',
};

/** @type {Language} */
let language = 'en';

/** @returns {Language} */
export function currentLanguage() {
  return language;
}

/** @param {Language} chosen */
export function setLanguage(chosen) {
  language = chosen;
  document.documentElement.lang = chosen;
  for (const element of document.querySelectorAll('[data-text]')) {
    element.textContent = text(String(element.getAttribute('data-text')));
  }
  for (const element of document.querySelectorAll('[data-label]')) {
    const label = text(String(element.getAttribute('data-label')));
    element.setAttribute('aria-label', label);
    if (element instanceof HTMLButtonElement) element.title = label;
  }
}

/** @param {string} key */
export function hasText(key) {
  return Object.hasOwn(TEXTS, key);
}

/**
 * @param {string} key
 * @param {Record<string, string | number>} values
 * @returns {string}
 */
export function text(key, values = {}) {
  const found = TEXTS[key];
  if (!found) throw new Error(`no text ${key}`);
  return found[language === 'en' ? 0 : 1].replace(/\{(\w+)\}/g, (_, name) => String(values[name]));
}
