"""How fast is the NC text: programs of 1 MB read, without running them."""

import json
import random
from collections.abc import Callable
from typing import Any

from axisrig.kernel.nc.text.parser import parse_program

SIZE = 1_000_000
AXES = ("X", "Y", "Z")
SEED = 1


def time_parse(repeats: int, clock_ns: Callable[[], int], as_json: bool) -> str:
    """Time the reading of two programs of 1 MB; the least of the repeats counts.

    moves: straight moves of three axes with feed and block number, as a CAM system writes them.
    mixed: 60 % of those; arcs, comments, parameters, branches, messages, measuring runs beside.
    Returns a table, or one JSON object: for each `bytes`, `blocks`, `s`, and `repeats`.
    """
    parse_program("G0 X1", axes=AXES)  # the grammar is made once in a process
    result: dict[str, Any] = {"repeats": repeats}
    for name, blocks in (("moves", _moves), ("mixed", _mixed)):
        text = _program(blocks)
        times_ns, count = [], 0
        for _ in range(repeats):
            begin = clock_ns()
            count = len(parse_program(text, axes=AXES).blocks)
            times_ns.append(clock_ns() - begin)
        result[name] = {"bytes": len(text), "blocks": count, "s": min(times_ns) / 1e9}
    if as_json:
        return json.dumps(result)
    lines = [f"NC text of 1 MB, least of {repeats}"]
    for name in ("moves", "mixed"):
        blocks_read, least_s = result[name]["blocks"], result[name]["s"]
        lines.append(f"{name}  {blocks_read} blocks  {least_s:.2f} s")
    return "\n".join(lines)


def _program(blocks: Callable[[random.Random, int], str]) -> str:
    source = random.Random(SEED)
    lines, size, number = ["%PERF"], 0, 0
    while size < SIZE:
        number += 10
        lines.append(blocks(source, number))
        size += len(lines[-1]) + 1
    return "\n".join(lines)


def _moves(source: random.Random, number: int) -> str:
    x, y, z = (f"{source.uniform(-100, 100):.3f}" for _ in AXES)
    return f"N{number} G1 X{x} Y{y} Z{z} F{source.randint(100, 3000)}"


def _mixed(source: random.Random, number: int) -> str:
    a, b, c, d = (f"{source.uniform(-100, 100):.3f}" for _ in range(4))
    n, parameter = number, source.randint(1, 50)
    forms = (
        (60, _moves(source, n)),
        (15, f"N{n} X{a} Y{b} ; next point"),
        (10, f"N{n} G{source.choice('23')} X{a} Y{b} I{c} J{d}"),
        (5, f"N{n} P{parameter} = P7 + {a} * SIN[P3]"),
        (3, f'N{n} #MSG SYN["X=%f", V.A.ABS.X]'),
        (3, f"N{n} G0 X[P1+{a}] Y=P2*2"),
        (2, f"N{n} $IF P1 > {parameter}\nN{n + 1} G0 Z{a}\nN{n + 2} $ENDIF"),
        (2, f"N{n} G100 Z{a} F200 (touch)"),
    )
    texts = [text for _, text in forms]
    return source.choices(texts, [weight for weight, _ in forms])[0]
