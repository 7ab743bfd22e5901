"""Random code, numbers and images for comparing the machines.

They range from random bytes to blocks that nest as deep as a machine remembers. Half of it is
nearly right: code that is accepted is run, and code that breaks one rule shows where that rule is.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import lru_cache

from tests.machines import Senses
from tests.oracle import programs
from tests.support.kits import KITS
from tiniscript import compile_text
from tiniscript.base.kit import Kit
from tiniscript.base.limits import TASKS
from tiniscript.bytecode.image import HEADER_BYTES, pack, with_checksum
from tiniscript.bytecode.opcodes import BY_NAME, UNO_OPS, Op

_EDGE_NUMBERS = (0, 1, 2, 3, 5, 499, 500, 501, 999, 1000, 1001, 1499, 1500, 1501, 2500, 46_340,
    46_341,
         65_535, 65_536, 1_465_431, 1_465_432, 2_147_483, 2_147_484, 10**6, 10**7, 5 * 10**7,
         10**8, 10**9, 2**30, 2**31 - 1001, 2**31 - 1000, 2**31 - 501, 2**31 - 500, 2**31 - 499,
         2**31 - 2, 2**31 - 1)  # fmt: skip
EDGES = sorted({*_EDGE_NUMBERS, *(-value for value in _EDGE_NUMBERS), -(2**31)})


def any_number(rng: random.Random) -> int:
    """Return a number of any size: as many small ones as large ones, and edges."""
    if rng.random() < 0.1:
        return rng.choice(EDGES)
    return rng.randrange(-(2**31), 2**31) >> rng.randrange(32)


# -- code ---------------------------------------------------------------------------------------


def operand_bytes(rng: random.Random, op: Op) -> bytes:
    """Return operands of `op`: often right ones, near jumps, and edges."""
    parts = b""
    for operand in op.operands:
        kind = operand.kind
        if kind.name.startswith(("fwd", "back")):
            value = rng.randrange(16) if rng.random() < 0.9 else rng.randint(kind.low, kind.high)
        elif kind.name in ("sensor", "actuator", "variable"):
            value = rng.randrange(4) if rng.random() < 0.98 else rng.randrange(40)
        elif rng.random() < 0.6:
            value = rng.randint(max(kind.low, -3), 12)
        else:
            value = rng.choice((kind.low, kind.high, rng.randint(kind.low, kind.high)))
        parts += value.to_bytes(kind.size, "little", signed=kind.is_signed and value < 0)
    return parts


def likely_code(rng: random.Random) -> bytes:
    """Return a sequence of instructions with a valid stack and a random structure."""
    code = b""
    depth = 0
    common_ops = rng.sample(UNO_OPS, rng.randint(3, 12))
    for _ in range(rng.randrange(1, 14)):
        op = rng.choice(common_ops if rng.random() < 0.8 else UNO_OPS)
        while depth < op.pops:
            if rng.random() < 0.8:
                code += bytes((BY_NAME["PUSH8"].code, rng.randrange(256)))
            else:
                code += simple("PUSH32") + any_number(rng).to_bytes(4, "little", signed=True)
            depth += 1
        if depth > op.pops and op.control_role not in ("value", "join") and rng.random() < 0.9:
            continue
        code += bytes([op.code]) + operand_bytes(rng, op)
        depth += op.pushes - op.pops
    return code


def nested_code(rng: random.Random, levels: int) -> bytes:
    """Return loops, branches and checks in one another, mostly right."""
    code = b""
    for _ in range(rng.randrange(4)):
        inner = nested_code(rng, levels - 1) if levels else likely_code(rng)[:8]
        is_far = rng.random() < 0.3
        kind = rng.randrange(8)
        answer, branch = (
            simple(rng.choice(("PUSH_TRUE", "PUSH_FALSE"))),
            rng.choice(("IF", "IF_NOT")),
        )
        slip = rng.choice((0, 0, 0, 0, 0, 0, 1, -1, 2, 65_530))
        if kind == 0:
            code += simple("FOREVER") + inner
            code += jump("AGAIN", is_far, len(inner) + (3 if is_far else 2) + slip)
        elif kind == 1:
            close = jump("NEXT", is_far, len(inner) + (3 if is_far else 2) + slip)
            times = bytes((BY_NAME["PUSH8"].code, rng.randrange(3)))
            counted_bytes = times + jump("LOOP", rng.random() < 0.5, len(inner + close) + slip)
            code += rng.choice((simple("LOOP8") + b"\x02", counted_bytes)) + inner + close
        elif kind == 2:
            body = inner + jump("BREAK_LOOP", is_far, slip + 3 if is_far else slip + 2)
            close = jump("NEXT", is_far, len(body) + (3 if is_far else 2))
            code += simple("LOOP8") + b"\x03" + body + close
        elif kind == 3:
            code += answer + jump(branch, is_far, len(inner) + slip) + inner
        elif kind == 4:
            else_code = likely_code(rng)[:6]
            skip = jump("ELSE", is_far, len(else_code) + slip)
            code += answer + jump(branch, is_far, len(inner) + len(skip)) + inner
            code += skip + else_code
        elif kind == 5:
            end = inner + simple("RETURN")
            code += jump("DEF", is_far, len(end) + slip) + end
            code += jump("CALL", is_far, len(end) + (3 if is_far else 2) + rng.choice((0, 0, slip)))
        elif kind == 6:
            code += simple("WATCH_FOREVER_WAIT") + bytes((BY_NAME["PUSH_READ"].code, 0))
            compared_bytes = bytes((BY_NAME["PUSH8"].code, 5)) + simple("LT") + simple("UNTIL")
            code += rng.choice((compared_bytes, simple("UNTIL8_LT") + b"\x05"))
            code += simple("UNTIL") if slip == 1 else b""
        else:
            inner = jump("BREAK", is_far, len(inner) + (3 if is_far else 2)) + inner
            loop_end = jump("AGAIN", is_far, len(inner) + (3 if is_far else 2))
            code += rng.choice(
                (simple("FOREVER"), jump("WHILE", is_far, len(inner + loop_end) + slip))
            )
            code += inner + loop_end
    return code


def deep_code(rng: random.Random) -> bytes:
    """Return one thing in itself or in a row, about as often as a machine remembers."""
    kind = rng.randrange(8)
    usual_counts = 15, 16, 17
    often = rng.choice({1: (16, 31, 32, 33), 5: (6, 7, 8), 6: (3, 4, 5)}.get(kind, usual_counts))
    yes = simple("PUSH_TRUE")
    code = simple("STOP") if rng.random() < 0.9 else b""
    if kind == 0:
        return simple("TIME") * often + simple("ADD") * (often - 1) + simple("SHOW")
    if kind == 1:
        for _ in range(often):
            code = yes + jump("IF", True, len(code)) + code + simple("STOP")
    elif kind == 2:
        for _ in range(often):
            code = loop(code, 2 if rng.random() < 0.3 else 1)
    elif kind == 3:
        for _ in range(often):
            code = simple("FOREVER") + code + jump("BREAK", True, 3)
            code += jump("AGAIN", True, len(code) + 2)
    elif kind == 4:
        join = rng.choice(("AND_THEN", "OR_ELSE"))
        code = yes
        for _ in range(often):
            code = yes + jump(join, rng.random() < 0.5, len(code)) + code
        code += simple("SHOW_YES_NO")
    elif kind == 5:  # each procedure calls the previous one
        code = jump("DEF", False, 2) + simple("STOP") + simple("RETURN")
        for _ in range(often):
            inner = jump("CALL", False, 6 if len(code) == 4 else 7) + simple("RETURN")
            code += jump("DEF", False, len(inner)) + inner
        code += jump("CALL", False, 5)
    elif kind == 6:  # loops around calls of procedures with loops
        inner = simple("STOP")
        for _ in range(often):
            inner = loop(inner, 1)
        ways = len(inner) + 1
        code = jump("DEF", False, ways) + inner + simple("RETURN")
        body = jump("CALL", False, ways + 2)
        for depth in range(rng.choice((10, 11, 12, 13))):
            body = simple("LOOP8") + b"\x01" + body + jump("NEXT", False, 4 + 4 * depth)
            # the call lies further after the procedure with each loop around it
            offset = body.index(BY_NAME["CALL"].code)
            body = body[: offset + 1] + bytes([ways + offset + 2]) + body[offset + 2 :]
        code += body
    else:
        end = simple("RETURN")
        code = (jump("DEF", False, len(end)) + end) * often + jump("CALL", False, 3)
    return code


def task_codes(seed: int, count: int) -> Iterator[bytes]:
    """Yield code with tasks, mostly right: up to one more than there may be, DEFs and loops."""
    rng = random.Random(seed)
    for _ in range(count):
        code = nested_code(rng, 1) if rng.random() < 0.3 else b""
        for _ in range(rng.choice((1, 1, 2, 3, TASKS, TASKS, TASKS + 1))):
            code += task_code(rng)
            if rng.random() < 0.4:
                code += nested_code(rng, 1) if rng.random() < 0.5 else likely_code(rng)
        yield code


def task_code(rng: random.Random) -> bytes:
    """Return a TASK or a WHEN, perhaps with a slip."""
    inner = b""
    for _ in range(rng.choice((0, 0, 1, 2, 4, 5))):
        inner = loop(inner, 1)
    if rng.random() < 0.3:
        inner += nested_code(rng, 1)
    look_code = simple("PUSH_TRUE") + simple("LOOK")
    if rng.random() < 0.2:
        look_code = b"\x05" + simple("PUSH_READ") + b"\x00" + simple("LT") + simple("LOOK")
        look_code = simple("PUSH8") + look_code if rng.random() < 0.7 else look_code
    kind = rng.choice(("TASK", "WHEN"))
    body = (look_code if kind == "WHEN" else b"") + inner + simple(f"END_{kind}")
    if rng.random() < 0.15:
        body = rng.choice(
            (
                inner + simple("END_TASK"),
                look_code + inner + simple("END_WHEN"),
                look_code + inner,
                inner + simple("RETURN"),
                look_code + look_code + simple("END_WHEN"),
                simple("UNTIL") + body,
            )
        )
    slip = rng.choice((0, 0, 0, 0, 0, 0, 0, 1, -1, 65_000))
    body_length = (len(body) + slip) % 65_536
    return bytes([BY_NAME[kind].code]) + body_length.to_bytes(2, "little") + body


def expression(rng: random.Random) -> bytes:
    """Return code that shows a value calculated from numbers of all sizes."""
    code, depth = b"", 0
    ops = [op for op in UNO_OPS if op.control_role == "value" and (op.pops or op.name == "TIME")]
    for _ in range(rng.randrange(1, 12)):
        op = rng.choice(ops)
        while depth < op.pops:
            code += simple("PUSH32") + any_number(rng).to_bytes(4, "little", signed=True)
            depth += 1
        code += bytes([op.code])
        depth += op.pushes - op.pops
    return code + simple("SHOW") * depth


def branches(rng: random.Random) -> bytes:
    """Return branches with values and constants that are often near one another."""
    code = b""
    body = simple("STOP")
    for _ in range(6):
        op = rng.choice([op for op in UNO_OPS if op.control_role == "if"])
        loop_count = rng.choice((0, 1, 2, 9, 200))
        code += simple("PUSH16") + loop_count.to_bytes(2, "little") + simple("SET_VAR") + b"\x01"
        *variable, compared_operand_kind, _ = [
            None,
            None,
            *(operand.kind for operand in op.operands),
        ][-3:]
        if compared_operand_kind is None:
            code += simple(rng.choice(("PUSH_TRUE", "PUSH_FALSE"))) + bytes([op.code])
        else:
            is_variable = variable != [None]
            code += b"" if is_variable else simple("PUSH_VAR_1")
            code += bytes([op.code, 1] if is_variable else [op.code])
            number = loop_count + rng.choice((-1, 0, 0, 1))
            size = compared_operand_kind.size
            code += (number & ((1 << 8 * size) - 1)).to_bytes(size, "little")
        code += len(body).to_bytes(op.operands[-1].kind.size, "little") + body
    return code


def loop(inner: bytes, times: int) -> bytes:
    return simple("LOOP8") + bytes([times]) + inner + jump("NEXT", True, len(inner) + 3)


def simple(name: str) -> bytes:
    return bytes([BY_NAME[name].code])


def jump(name: str, is_far: bool, distance: int) -> bytes:
    size = 2 if is_far else 1
    return simple(name + "_FAR" * is_far) + (distance & ((1 << 8 * size) - 1)).to_bytes(
        size, "little"
    )


def mutate_code(rng: random.Random, code: bytes, other_code: bytes) -> bytes:
    data = bytearray(code)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        offset = rng.randrange(len(data) + 1)
        kind = rng.randrange(7)
        if kind == 0:
            data[offset:offset] = bytes([rng.randrange(256)])
        elif kind == 1:
            del data[offset : offset + rng.choice((1, 1, 2, 3))]
        elif kind == 2:
            data[offset:] = other_code[rng.randrange(len(other_code) + 1) :]
        elif offset < len(data):
            delta = rng.choice((1, 255, 2, 254))
            choices = (rng.randrange(256), rng.choice(UNO_OPS).code, (data[offset] + delta) % 256)
            data[offset] = rng.choice(choices)
    return bytes(data)


def random_codes(seed: int, count: int) -> Iterator[bytes]:
    """Yield random and mutated codes: programs, likely instructions, nested and deep blocks."""
    rng = random.Random(seed)
    bases = [b"", b""]
    for number in range(count):
        kind = number % 8
        if number % 400 == 0:
            oracle_kit, kit = KITS[number // 400 % 2]
            text = programs.program(rng, oracle_kit)
            bases.append(compile_text(text, kit, optimize=rng.random() < 0.5).code)
            bases = bases[-20:]
            yield bases[-1]
        elif number % 40 == 0:
            yield deep_code(rng)
        elif number % 40 == 16:
            yield expression(rng)
        elif number % 40 == 24:
            yield branches(rng)
        elif kind == 0:
            yield rng.randbytes(rng.randrange(8))
        elif kind in (1, 2):
            yield likely_code(rng)
        elif kind == 3:
            yield nested_code(rng, rng.randrange(4))
        elif kind == 4:
            yield mutate_code(rng, nested_code(rng, rng.randrange(3)), likely_code(rng))
        else:
            yield mutate_code(rng, rng.choice(bases), rng.choice(bases))


# -- programs and images ------------------------------------------------------------------------


@lru_cache(maxsize=1)
def some_programs() -> tuple[tuple[bytes, Kit, Senses], ...]:
    """Return random programs with their robots."""
    codes = []
    for seed in range(300):
        rng = random.Random(seed)
        oracle_kit, kit = KITS[seed % 2]
        image = compile_text(programs.program(rng, oracle_kit), kit).image
        senses = Senses(programs.senses(rng, oracle_kit), 20_000, 5000, seed + 1)
        codes.append((image, kit, senses))
    return tuple(codes)


def random_images(seed: int, count: int) -> Iterator[bytes]:
    """Yield images with a change in their header, the checksum mended in most of them."""
    rng = random.Random(seed)
    for _ in range(count):
        start, code = rng.choice(("SI", "SB", "PING")), rng.randbytes(rng.randrange(9))
        later_bytes = rng.randbytes(rng.choice((0, 0, 1, 7, 240)))
        yield changed_image(rng, pack(start, rng.choice((0, 1, 0x1234)), code, later_bytes))


def images_of_programs(seed: int, count: int) -> Iterator[tuple[bytes, Kit]]:
    """Yield images of programs, half of them with a change, and the kits that they are for."""
    rng = random.Random(seed)
    for number in range(count):
        image, kit, _ = some_programs()[number % len(some_programs())]
        yield (changed_image(rng, image) if rng.random() < 0.5 else image), kit


def changed_kit(rng: random.Random, kit: Kit) -> Kit:
    """Return a kit with one device that is another one, is missing, or has come."""
    sensors = list(kit.sensors)
    index = rng.randrange(len(sensors))
    change = rng.randrange(4)
    if change == 0:
        sensors[index] = sensors[index]._replace(unit=sensors[index].unit + "x")
    elif change == 1:
        sensors[index] = sensors[index]._replace(low=sensors[index].low - 1)
    elif change == 2:
        del sensors[index]
    else:
        sensors.append(sensors[index]._replace(name="ANOTHER"))
    return kit._replace(sensors=tuple(sensors))


def changed_image(rng: random.Random, data: bytes) -> bytes:
    image = bytearray(data)
    for _ in range(rng.choice((0, 1, 1, 2))):
        offset = rng.randrange(min(len(image), HEADER_BYTES))
        image[offset] = rng.choice((0, 1, 2, 3, HEADER_BYTES, 127, 128, 255))
    if rng.random() < 0.3:
        del image[rng.randrange(len(image) + 1) :]
    elif rng.random() < 0.2:
        image += rng.randbytes(rng.randrange(3))
    is_mended = rng.random() < 0.8 and len(image) >= HEADER_BYTES
    return with_checksum(bytes(image)) if is_mended else bytes(image)
