"""Which function each call of the solve representation means.

The compiler numbers the calls (`owner`) without naming the function. In its other representation
every call names function and place; both number the calls of one equation in the order of the text.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.programs import start_programs

_TOKENS = re.compile(
    rb'"(?:[^"\\]|\\.)*"|//[^\n]*|/\*.*?\*/|\b(?:end\s+)?for\b|[;()\[\]{}]', re.DOTALL
)

_BEFORE = re.compile(rb";|\b(?:then|else|loop|equation|algorithm)\b")


def read_owners(ir: Ir) -> dict[int, int]:
    """Number of the function by the number of the call.

    Raises BuildError where an equation leaves open which of its functions is meant.
    """
    named = _named_calls(ir)
    owners: dict[int, int] = {}
    taken: set[tuple[int, int]] = set()  # source and start of the calls that are known
    later = []
    for span, numbers in (*_numbered_calls(ir.solve), *_numbered_calls(start_programs(ir))):
        inside = _inside(named, span, (span.get("start", 0), span.get("end", 0)))
        if inside:
            owners |= _matched(ir, span, numbers, inside)
            taken |= {(span["source"], start) for start in inside}
        else:  # the span is a name only, such as the variable of a when-clause
            later.append((span, numbers))
    for span, numbers in later:
        unknown = numbers - owners.keys()
        if unknown:
            around = _inside(named, span, _statement(ir, span))
            free = {k: v for k, v in around.items() if (span["source"], k) not in taken}
            owners |= _matched(ir, span, unknown, free)
    return owners


def _inside(
    named: Mapping[int, Sequence[tuple[int, int, set[int]]]],
    span: Mapping[str, int],
    limits: tuple[int, int],
) -> dict[int, set[int]]:
    """Start and functions of the calls between two places of a source."""
    return {
        start: functions
        for start, end, functions in named.get(span.get("source", -1), ())
        if limits[0] <= start and end <= limits[1]
    }


def _matched(
    ir: Ir, span: Mapping[str, int], numbers: set[int], inside: Mapping[int, set[int]]
) -> dict[int, int]:
    """The function of each call of one equation."""
    meant = set().union(*inside.values())
    if len(meant) == 1:
        return dict.fromkeys(numbers, meant.pop())
    if len(inside) == len(numbers) and all(len(f) == 1 for f in inside.values()):
        ordered = [next(iter(inside[start])) for start in sorted(inside)]
        return dict(zip(sorted(numbers), ordered, strict=True))
    message = "calls of several functions in one equation: give each an equation of its own"
    raise ir.error(span or None, message)


def _named_calls(ir: Ir) -> dict[int, list[tuple[int, int, set[int]]]]:
    """The calls that can be left at run time, by source: start, end and the functions there."""
    found: dict[int, dict[tuple[int, int], set[int]]] = {}
    for expression in ir.dae["expressions"]:
        operation, span = expression["operation"], expression["provenance"].get("span")
        if operation["kind"] == "call" and span and expression["variability"] != "constant":
            place = found.setdefault(span["source"], {})
            key = (span["start"], span["end"])
            place.setdefault(key, set()).add(operation["function"])
    return {
        source: [(start, end, functions) for (start, end), functions in calls.items()]
        for source, calls in found.items()
    }


def _numbered_calls(node: Any) -> Iterator[tuple[Mapping[str, int], set[int]]]:
    """The span of each program with calls, and their numbers."""
    if isinstance(node, Mapping):
        if "ops" in node:
            numbers = set(_in_ops(node["ops"]))
            if numbers:
                yield node.get("span") or {}, numbers
            return
        for part in node.values():
            yield from _numbered_calls(part)
    elif isinstance(node, list):
        for part in node:
            yield from _numbered_calls(part)


def _in_ops(ops: Sequence[Mapping[str, Any]]) -> Iterator[int]:
    for op in ops:
        if op["kind"] == "PureCall":
            yield op["owner"]
        for arm in op.get("arms", ()):
            yield from _in_ops(arm["condition"]["ops"])
            yield from _in_ops(arm["result"]["ops"])
        if "fallback" in op:
            yield from _in_ops(op["fallback"]["ops"])


def _statement(ir: Ir, span: Mapping[str, int]) -> tuple[int, int]:
    """Start and end, in bytes, of the statement around a span; of a loop all of it."""
    if span.get("source") not in ir.files:
        return 0, 0
    text = ir.files[span["source"]][1].encode()
    before = [m.end() for m in _BEFORE.finditer(text, 0, span["start"])]
    start = before[-1] if before else 0
    depth = brackets = 0
    for token in _TOKENS.finditer(text, start):
        word = token.group(0)
        if word in (b"(", b"[", b"{"):
            brackets += 1
        elif word in (b")", b"]", b"}"):
            brackets -= 1
        elif word == b"for" and brackets == 0:
            depth += 1
        elif word.startswith(b"end"):
            depth -= 1
        elif word == b";" and depth <= 0 and token.start() >= span["end"]:
            return start, token.start()
    return start, len(text)
