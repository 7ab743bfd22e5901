"""The lexicon of Spanish: what a word may mean. Words are in capitals, without accents.

What something means is a word of the language; `turn`; `number`, `power` or `unit` with its value
(a unit with how many thousandths of it one is); `value`, the name of what a call takes, by its
unit; `filler`, which changes nothing; or a part of a sentence that the rows of `rows` name.
"""

TABLE = """
# meaning       | words
# commands, blocks and values
F               | ADE ADEL ADELANTE AVANZAR AVANZA AVANCE ADELANTA CAMINAR CAMINA ANDAR ANDA CORRER CORRE MOVER MUEVE MUEVETE DERECHO RECTO FRENTE SIGUE SIGA SEGUIR
B               | ATR ATRAS RETROCEDER RETROCEDE REVERSA REGRESA REGRESAR
L               | IZQUIERDA IZQ GIRAR_IZQUIERDA
R               | DERECHA DER GIRAR_DERECHA
S               | PARAR PARA PARE ALTO DETENER DETENTE FRENAR FRENA DETEN PARATE QUIETO
W               | ESPERAR ESPERA PAUSA PAUSAR DORMIR DUERME
M               | MOTORES
BEEP            | BIP PIP BOCINA ZUMBADOR ALARMA CLAXON PITAR PITA PITO PITIDO SONAR SUENA TOCAR TOCA SONIDO TONO VIIP BIIP BIPP MUSICA NOTA
SHOW            | ENSENA ENSENIA MOSTRAR MUESTRA IMPRIMIR IMPRIME DECIR DI ESCRIBIR ESCRIBE SHOU CHOU CHOW CHO XOU SOU
START           | INICIO COMENZAR COMIENZO EMPEZAR EMPIEZA INICIAR ESTAR ESTARD
IF              | SI_ES CUANDO
ELSEIF          | SINO_SI
ELSE            | SINO SI_NO OTRO DE_LO_CONTRARIO EL_SE ELS_E
ENDIF           | FIN_SI FINSI FIN_IF FINIF EN_IF ENIF
LOOP            | REPETIR REPITE BUCLE CICLO PARA_CADA VECES LUP LUUP LUB
END_LOOP        | FIN_BUCLE FIN_LOOP FINLOOP FIN_REPETIR FINREPETIR FIN_REPITE FIN_CICLO FIN_PARA FINPARA SIGUIENTE FIN_FOREVER FIN_SIEMPRE FINSIEMPRE END_LUP ENDLUP EN_LUP ENLUP EN_LOOP ENLOOP FIN_LUP
WHILE           | MIENTRAS UAIL GUAIL GUAIEL WAIL HUAIL JUAIL UAIEL WUAIL
END_WHILE       | FIN_MIENTRAS FINMIENTRAS FIN_WHILE FINWHILE END_WAIL END_GUAIL END_UAIL ENDWAIL ENDGUAIL ENDUAIL
FOREVER         | SIEMPRE INFINITO PARA_SIEMPRE POR_SIEMPRE FOREBER FOREVE FOREBE FOR_EVER FOR_EBER FOREVERR FORREVER FOREVA
BREAK           | SALIR ROMPER BREC BREIC BREK
DEF             | DEFINIR FUNCION PROCEDIMIENTO
END_DEF         | FIN_FUNCION FINFUNCION FIN_DEF FINDEF ENDEF EN_DEF
UNTIL           | HASTA HASTA_QUE
TRUE            | VERDADERO CIERTO TRU TRUU
FALSE           | NO FALSO FALS FOLS FALCE
RANDOM          | AZAR ALEATORIO DADO RANDON RAMDOM RAMDON RANDUM RANDOMM
ROUND           | REDONDEAR RAUND RAUN ROUN
TIME            | TIEMPO TAIM TAIN TAIME
BUTTON          | BOTON PULSADOR
DISTANCE        | DISTANCIA ULTRASONIDO ULTRASONICO
GRIPPER         | PINZA PINZAS GARRA GARRAS
LED             | FOCO LAMPARA BOMBILLA
BATTERY         | BATERIA PILA PILAS
TEMPERATURE     | TEMPERATURA TERMOMETRO
LINE_L          | LINEA_I LINEA_IZQUIERDA
LINE_R          | LINEA_D LINEA_DERECHA
LIGHT_R         | LUZ_D LUZ_DERECHA LAIT_R LIGTH_R LIGH_R
LIGHT_L         | LUZ_I LUZ_IZQUIERDA LAIT_L LIGTH_L LIGH_L
# what an actuator of a kit is set to
lit             | PRENDIDO PRENDIDA ENCENDIDO ENCENDIDA
dark            | APAGADO APAGADA
most            | ABIERTO ABIERTA ABRIR ABRE
least           | CERRADO CERRADA CERRAR CIERRA
# which way: the word behind says it
turn            | DOBLA DOBLAR DOBLAS GIRA GIRAR GIRAS GIRE GIRO ROTA ROTAR VOLTEA VOLTEAR VOLTEAS VOLTEE
# numbers in words
number 1        | UNO UN UNA
number 2        | DOS
number 3        | TRES
number 4        | CUATRO
number 5        | CINCO
number 6        | SEIS
number 7        | SIETE
number 8        | OCHO
number 9        | NUEVE
number 10       | DIEZ
number 11       | ONCE
number 12       | DOCE
number 15       | QUINCE
number 20       | VEINTE
number 25       | VEINTICINCO
number 30       | TREINTA
number 40       | CUARENTA
number 50       | CINCUENTA
number 60       | SESENTA
number 70       | SETENTA
number 80       | OCHENTA
number 90       | NOVENTA
number 100      | CIEN CIENTO
number 200      | DOSCIENTOS
number 300      | TRESCIENTOS
number 400      | CUATROCIENTOS
number 500      | QUINIENTOS
number 1000     | MIL
power 100       | ALTA MAXIMO MAXIMA RAPIDO RAPIDA RAPIDAMENTE RAPIDITO VELOZ FUERTE TODO TODA
power 50        | MEDIO MEDIA MITAD
power 40        | LENTO LENTA LENTITO DESPACIO DESPACITO LENTAMENTE
# units: which one, and how many thousandths of it
unit s 1000     | SEG SEGS SEGUNDO SEGUNDOS
unit s 1        | MILISEGUNDO MILISEGUNDOS
unit s 60000    | MINUTO MINUTOS
unit s 3600000  | HORA HORAS
unit cm 1000    | CENTIMETRO CENTIMETROS
unit cm 30480   | PIE PIES
unit cm 2540    | PULGADA PULGADAS
unit cm 100     | MILIMETRO MILIMETROS
unit cm 100000  | METRO METROS
unit Hz 1000    | HERCIO HERCIOS
unit ° 1000     | GRADO GRADOS
unit % 1000     | PORCIENTO POTENCIA
unit steps 1000 | PASO PASOS
unit times 1000 | VEZ VECES
# what a value is called before its number
value %         | POTENCIA VELOCIDAD VEL FUERZA POT
value s         | TIEMPO DURACION SEGUNDOS
value Hz        | FRECUENCIA TONO
value left      | IZQUIERDA IZQ
value right     | DERECHA DER
# what stands beside a command and changes nothing
filler          | A AL CON DE EL EN ES FAVOR HACER HACIA HAZ IR LA LADO LAS LE LO LOS MI POR PUEDE QUE QUIERO DEBE TIENE VA VAMOS VE SE SIGUE SOLO SU TE TU UN UNA USANDO VALOR Y DEL CARRO CARRITO AUTO ROBOT HOLA DURANTE COMA
# other words of a sentence
then            | Y E LUEGO DESPUES ENTONCES
soon            | Y LUEGO DESPUES ENTONCES AL POR A TAMBIEN ULTIMO FINAL FIN MAS TARDE CONTINUACION SEGUIDO DE FINALMENTE
first           | Y LUEGO DESPUES ENTONCES PRIMERO AHORA FINALMENTE ENSEGUIDA
do              | ENTONCES HACER HAZ
make            | HACER HAZ HAGA
times           | VECES VEZ
the             | LA EL
is              | ES SEA ESTA ESTE
there           | HAY HAYA VE DETECTA
than            | QUE DE DEL A
to              | A AL EN COMO
less            | MENOR MENOS BAJO
more            | MAYOR
extra           | MAS
equal           | IGUAL
different       | DISTINTO DISTINTA DIFERENTE
between         | ENTRE
plus            | MAS
during          | POR DURANTE
seconds         | SEG SEGS SEGUNDO SEGUNDOS
please          | GRACIAS
unless          | A_MENOS_QUE SALVO EXCEPTO
until           | HASTA
when            | CUANDO SI
call            | LLAMAR LLAMA EJECUTAR EJECUTA HACER HAZ USA
read            | LEER LEE MEDIR MIDE
set             | PON PONER FIJAR FIJA ASIGNAR ASIGNA SUBE BAJA CAMBIA
keep            | GUARDAR GUARDA
beside          | CON MIENTRAS
etc             | ETC ETCETERA
idle            | CM SEG SEGUNDOS EL AL ROBOT CARRO CARRITO GRACIAS
act             | VUELVE VOLVER BAILA BAILAR ACELERA CANTA ESQUIVA EVITA AGARRA COGE SUELTA
small           | PARA DI OTRO MOTOR MOTORES A E
end             | FIN FINAL TERMINAR ACABAR
program         | PROGRAMA ALGORITMO
count           | PARA DESDE
each            | CADA
jump            | SALTA SALTAR IRA IR_A
on              | PRENDER PRENDE ENCENDER ENCIENDE
off             | APAGAR APAGA
over            | ENTRE DIVIDIDO
same            | IDEM IGUAL MISMO MISMA OTRA NUEVO NUEVAMENTE
above           | ARRIBA ANTES ANTERIOR VEZ
again           | CONTINUA CONTINUAR
sensor          | LUZ LINEA
range           | RANGO
wall            | PARED OBSTACULO MURO
engine          | MOTORES MOTOR
leave           | SALIR ROMPER
no              | NO
"""
