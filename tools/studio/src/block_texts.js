// The words on the blocks, in English and Spanish. `%1` and so on are where values go.

import { currentLanguage } from './texts.js';

/** @type {Record<string, [string, string]>} */
export const BLOCK_TEXTS = {
  program: ['%1', '%1'],
  SI: ['SI: start at once', 'SI: empieza enseguida'],
  SB: ['SB: start with the button', 'SB: empieza con el botón'],
  PING: ['PING: is the robot there?', 'PING: ¿está el robot?'],
  F: ['F forward', 'F adelante'],
  B: ['B back', 'B atrás'],
  L: ['L turn left', 'L gira a la izquierda'],
  R: ['R turn right', 'R gira a la derecha'],
  move: ['%1 %2 s at %3 %%', '%1 %2 s al %3 %%'],
  move_until: ['%1 %2 s at %3 %%, or until %4', '%1 %2 s al %3 %%, o hasta que %4'],
  wait: ['W wait %1 s', 'W espera %1 s'],
  wait_until: ['W wait %1 s, or until %2', 'W espera %1 s, o hasta que %2'],
  motors: ['M motors: left %1 %%, right %2 %%', 'M motores: izquierdo %1 %%, derecho %2 %%'],
  stop: ['S stop', 'S detente'],
  start: ['START beginning', 'START inicio'],
  beep: ['BEEP sound %1 s at %2 Hz', 'BEEP sonido %1 s de %2 Hz'],
  show: ['SHOW %1', 'SHOW muestra %1'],
  read: ['measure %1 now', 'mide %1 ahora'],
  set: ['%1 set to %2', '%1 ponlo en %2'],
  call: ['do %1', 'haz %1'],
  assign: ['%1 = %2', '%1 = %2'],
  if: ['IF %1', 'IF si %1'],
  elseif: ['ELSEIF %1', 'ELSEIF o si %1'],
  else: ['ELSE', 'ELSE si no'],
  loop: ['LOOP repeat %1 times', 'LOOP repite %1 veces'],
  forever: ['LOOP repeat forever', 'LOOP repite sin fin'],
  while: ['WHILE repeat while %1', 'WHILE repite mientras %1'],
  break: ['BREAK leave the loop', 'BREAK sal de la repetición'],
  def: ['DEF new word %1', 'DEF palabra nueva %1'],
  comment: ['// %1', '// %1'],
  grey: ['%1', '%1'],
  number: ['%1', '%1'],
  name: ['%1', '%1'],
  sensor: ['%1', '%1'],
  truth: ['%1', '%1'],
  TRUE: ['TRUE yes', 'TRUE sí'],
  FALSE: ['FALSE no', 'FALSE no'],
  time: ['TIME seconds so far', 'TIME segundos transcurridos'],
  endless: ['FOREVER without end', 'FOREVER sin fin'],
  math: ['%1 %2 %3', '%1 %2 %3'],
  compare: ['%1 %2 %3', '%1 %2 %3'],
  logic: ['%1 %2 %3', '%1 %2 %3'],
  AND: ['AND and', 'AND y'],
  OR: ['OR or', 'OR o'],
  not: ['NOT not %1', 'NOT no %1'],
  negative: ['− %1', '− %1'],
  brackets: ['( %1 )', '( %1 )'],
  round: ['ROUND %1 to %2 decimals', 'ROUND redondea %1 a %2 decimales'],
  abs: ['ABS %1 without minus', 'ABS %1 sin menos'],
  extreme: ['%1 of %2 and %3', '%1 de %2 y %3'],
  MIN: ['MIN the smaller', 'MIN el menor'],
  MAX: ['MAX the larger', 'MAX el mayor'],
  random: ['RANDOM from %1 to %2', 'RANDOM al azar de %1 a %2'],
};

/** What a block does, said when a pointer rests on it. @type {Record<string, [string, string]>} */
export const TIPS = {
  program: ['When the program starts. Hang the blocks below it.', 'Cuándo empieza el programa. Cuelga los bloques debajo.'],
  move: ['The robot drives or turns: how long, in seconds, and with how much power, from 0 to 100 %.',
    'El robot avanza o gira: cuánto tiempo, en segundos, y con cuánta potencia, de 0 a 100 %.'],
  move_until: ['The move ends when its time is over, or as soon as this is true.',
    'El movimiento termina cuando se acaba su tiempo, o en cuanto esto se cumple.'],
  wait: ['Nothing changes for so long.', 'Nada cambia durante ese tiempo.'],
  wait_until: ['Waits until this is true, and at most so long.', 'Espera hasta que esto se cumpla, y como máximo ese tiempo.'],
  motors: ['Sets both motors, from -100 to 100 %, and goes on at once.', 'Pone los dos motores, de -100 a 100 %, y sigue enseguida.'],
  stop: ['The robot stops.', 'El robot se detiene.'],
  start: ['Does nothing: it names the beginning.', 'No hace nada: solo marca el comienzo.'],
  beep: ['The buzzer sounds; more hertz are higher.', 'Suena el zumbador; con más hercios, más agudo.'],
  show: ['Sends a value to the computer or phone.', 'Envía un valor a la computadora o al teléfono.'],
  read: ['Takes a reading, which counts from now on.', 'Toma una medida, que vale desde ahora.'],
  set: ['Sets what the robot has: a gripper, a lamp.', 'Mueve o enciende lo que tiene el robot: una pinza, una lámpara.'],
  call: ['Does what the word of your own says.', 'Hace lo que dice tu palabra.'],
  assign: ['Keeps a value under a name.', 'Guarda un valor con un nombre.'],
  if: ['Does what is inside only if this is true.', 'Hace lo que está adentro solo si esto se cumple.'],
  loop: ['Does what is inside so many times.', 'Hace lo que está adentro ese número de veces.'],
  forever: ['Does what is inside again and again.', 'Hace lo que está adentro una y otra vez.'],
  while: ['Does what is inside as long as this is true.', 'Hace lo que está adentro mientras esto se cumpla.'],
  break: ['Leaves the innermost loop.', 'Sale de la repetición más cercana.'],
  def: ['A word of your own: put in what it does, and use it below.', 'Una palabra tuya: pon adentro lo que hace, y úsala más abajo.'],
  comment: ['A note for people; the robot does not read it.', 'Una nota para las personas; el robot no la lee.'],
  grey: ['The compiler does not understand this line. Change it here or in the text.',
    'El compilador no entiende esta línea. Cámbiala aquí o en el texto.'],
  more: ['Add a case', 'Agregar un caso'],
  less: ['Take the last case away', 'Quitar el último caso'],
};

/** Names of the groups in the toolbox. @type {Record<string, [string, string]>} */
export const GROUPS = {
  move: ['Move', 'Moverse'],
  time: ['Wait, sound', 'Tiempo, sonido'],
  control: ['Repeat', 'Repetir'],
  choose: ['Decide', 'Decidir'],
  sensors: ['Robot', 'Robot'],
  decide: ['Compare', 'Comparar'],
  numbers: ['Numbers', 'Números'],
  names: ['Variables', 'Variables'],
  words: ['My words', 'Mis palabras'],
  others: ['Notes', 'Notas'],
};

/**
 * @param {Record<string, [string, string]>} table
 * @param {string} key
 * @returns {string}
 */
export function said(table, key) {
  const found = table[key];
  if (!found) throw new Error(`no text ${key}`);
  return found[currentLanguage() === 'en' ? 0 : 1];
}
