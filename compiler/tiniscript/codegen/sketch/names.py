"""The C++ names of a program's names: `MY_SPEED` becomes `mySpeed`.

Names are unique and differ from those of C++, of the Arduino core or of a helper. Their names, and
the texts of a sketch, are in the catalogue `sketch`.
"""

from __future__ import annotations

import re

from tiniscript.base.languages import find_text, languages, plain_text_keys, text

# Names that differ by language, and the parameters and variables of helpers.
IDENTIFIERS, LOCALS = (
    [key.partition("/")[2] for key in plain_text_keys("sketch") if key.startswith(kind)]
    for kind in ("name/", "local/")
)
_LOCAL = re.compile(rf"(?<![$\w.])({'|'.join(LOCALS)})(?!\w)")


def note_text(key: str, language: str) -> str:
    """Return a comment, or an empty text if there is none."""
    return find_text("sketch", f"said/{key}", language) or ""


def translated_name(key: str, language: str) -> str:
    """Return the translation of a name; other names stay unchanged."""
    return find_text("sketch", f"name/{key}", language) or key


def translate_locals(code: str, language: str) -> str:
    """Return a helper whose parameters and own variables have their names in the language."""
    return _LOCAL.sub(lambda match: text("sketch", f"local/{match[1]}", language), code)


RESERVED = frozenset(
    # a table of words
    """
    abort abs acos acosf alignas alignof analogInputToDigitalPin analogRead analogReference
    analogWrite and arduino asin asinf asm atan atan2 atan2f atanf atexit atof atoi atol
    attachInterrupt auto bit bitClear bitRead bitSet bitToggle bitWrite bitand bitor bool boolean
    break bsearch byte calloc case catch cbrt cbrtf ceil ceilf char class clearerr clearerror cli
    clock clockCyclesPerMicrosecond clockCyclesToMicroseconds compl const constexpr constrain
    continue copysign copysignf cos cosf cosh coshf decltype default degrees delay
    delayMicroseconds delete detachInterrupt digitalPinToBitMask digitalPinToInterrupt
    digitalPinToPort digitalPinToTimer digitalRead digitalWrite div do double dtostre dtostrf else
    enum exception exit exp expf explicit export extern fabs fabsf false fclose fdevopen fdim
    fdimf fdopen feof ferror fflush ffs ffsl ffsll fgetc fgetpos fgets fileno final float floor
    floorf fma fmaf fmax fmaxf fmin fminf fmod fmodf fopen for fprintf fputc fputs fread free
    freopen frexp frexpf friend fscanf fseek fsetpos ftell fwrite getc getchar getenv gets goto
    hertz highByte hypot hypotf if index init initVariant inline int interrupts isAlpha
    isAlphaNumeric isAscii isControl isDigit isGraph isHexadecimalDigit isLowerCase isPrintable
    isPunct isSpace isUpperCase isWhitespace isalnum isalpha isascii isblank iscntrl isdigit
    isfinite isfinitef isgraph isinf isinff islower isnan isnanf isprint ispunct isspace isupper
    isxdigit itoa labs late ldexp ldexpf ldiv left list log log10 log10f logf long loop lowByte
    lrint lrintf lround lroundf ltoa main makeWord malloc map max memccpy memchr memcmp memcpy
    memmem memmove memrchr memset micros microsecondsToClockCycles millis min modf modff mutable
    namespace new noInterrupts noTone noexcept not null nullptr offsetof operator or override
    percent perror pinMode portInputRegister portModeRegister portOutputRegister pow power powf
    printf private protected public pulseIn pulseInLong putc putchar puts qsort radians rand
    random randomSeed read realloc register remove rename reti return rewind right round roundf
    scanf seconds sei serial serialEventRun setbuf setup setvbuf shiftIn shiftOut short signbit
    signbitf signed sin sinf sinh sinhf sizeof snprintf sprintf sq sqrt sqrtf square squaref srand
    srandom sscanf static stderr stdin stdout strcasecmp strcasestr strcat strchr strchrnul strcmp
    strcoll strcpy strcspn strdup strerror string strlcat strlcpy strlen strlwr strncasecmp
    strncat strncmp strncpy strnlen strpbrk strrchr strrev strsep strspn strstr strtod strtok
    strtol strtoul struct strupr strxfrm switch system tan tanf tanh tanhf template this throw
    time tmpfile tmpnam toAscii toascii tolower tone toupper true trunc truncf try typedef typeid
    typename u16 u32 u8 ultoa ungetc union unsigned using utoa value vfprintf vfscanf virtual void
    volatile vprintf vscanf vsnprintf vsprintf while word write xor yield
    """.split()  # noqa: SIM905
)


# The counter of a LOOP, or the copy of a value.
_COUNTER_NAME = re.compile(r"[ijk][0-9]*|first[0-9]+")


class Names:
    """Gives names in the order in which it is asked."""

    def __init__(self, language: str) -> None:
        self._prefix = text("sketch", "prefix", language)
        self._taken_names = {
            translated_name(name, language) for name in IDENTIFIERS for language in languages()
        }

    def name_of(self, name: str, verb: str = "") -> str:
        """Return the name in C++ of a name in capitals; `verb` is the verb of a function."""
        words = [word for word in name.lower().split("_") if word]
        identifier = "".join(word.capitalize() for word in words)
        identifier = verb + identifier if verb else words[0] + identifier[len(words[0]) :]
        if (
            identifier in RESERVED
            or identifier in self._taken_names
            or _COUNTER_NAME.fullmatch(identifier)
        ):
            identifier = self._prefix + identifier[0].upper() + identifier[1:]
        candidate, number = identifier, 2
        while candidate in self._taken_names:
            candidate, number = f"{identifier}_{number}", number + 1
        self._taken_names.add(candidate)
        return candidate


def counter(depth: int) -> str:
    """Return the variable that counts a LOOP inside so many others."""
    return "ijk"[depth] if depth < 3 else f"i{depth + 1}"
