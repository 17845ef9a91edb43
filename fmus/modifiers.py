"""Modifiers that the compiler drops without a word, found in the text of a model.

Source: behaviour of rumoca 0.10.2. Of `redeclare model M = C(k = 5)` and of
`replaceable model M = C constrainedby B(k = 6)` the values in brackets have no effect. Those of
`replaceable C c constrainedby B(k = 6)` act on what `c` is redeclared to, but not on C itself.
"""

import re
from collections.abc import Iterator, Mapping

from fmus.ir import Ir

_CLASS = r"(?:model|block|class|record|connector|package|function|type)"
_REDECLARED = re.compile(
    rf"\bredeclare\s+(?:(?:final|replaceable)\s+)*{_CLASS}\s+\w+\s*=\s*[\w.]+\s*\("
)
_CONSTRAINED = re.compile(r"\breplaceable\b([^;]*?)\bconstrainedby\s+[\w.]+\s*\(([^;]*)")
_MODIFIED = re.compile(r"(\w+)\s*=")
_HEAD = re.compile(rf"\b{_CLASS}\s+(\w+)(?!\w)(?!\s*=)")
# Comments and strings, also the HTML of the documentation.
_NO_CODE = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|/\*.*?\*/', re.DOTALL)

# Number of the file, offset of the first character, text without comments and inner classes.
Body = tuple[int, int, str]


def refuse_dropped_modifiers(ir: Ir) -> None:
    """Stop at such a modifier in a class that the model uses.

    A class counts as used when its name stands in one that is used.
    Raises BuildError with the place of the modifier.
    """
    bodies: dict[str, list[Body]] = {}
    for number, (_, text) in ir.files.items():
        for name, body in _classes(number, _blank(_NO_CODE, text), 0):
            bodies.setdefault(name, []).append(body)
    for number, offset, text in _used(bodies, ir.model.rsplit(".", 1)[-1]):
        place = _dropped(text)
        if place is not None:
            start = len(ir.files[number][1][: offset + place].encode())
            message = (
                "the compiler drops the modifier of a class in redeclare and constrainedby;"
                " modify the component instead"
            )
            raise ir.error({"source": number, "start": start}, message)


def _dropped(text: str) -> int | None:
    """Where a modifier stands that has no effect."""
    found = _REDECLARED.search(text)
    if found:
        return found.start()
    for constrained in _CONSTRAINED.finditer(text):
        own, wanted = constrained.groups()
        is_class = re.match(rf"\s*{_CLASS}\b", own) is not None
        if is_class or not set(_MODIFIED.findall(wanted)) <= set(_MODIFIED.findall(own)):
            return constrained.start()
    return None


def _blank(pattern: re.Pattern[str], text: str) -> str:
    """The text with blanks in place of what matches; lines and offsets stay."""
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)


def _classes(number: int, text: str, offset: int) -> Iterator[tuple[str, Body]]:
    """Every class of a text, inner ones on their own."""
    position = 0
    while head := _HEAD.search(text, position):
        name = head.group(1)
        end = re.compile(rf"\bend\s+{name}\s*;").search(text, head.end())
        position = head.end() if end is None else end.end()
        if end is not None:
            inner = text[head.end() : end.start()]
            begin = offset + head.end()
            own = inner
            for _, (_, at, body) in _classes(number, inner, begin):
                own = own[: at - begin] + " " * len(body) + own[at - begin + len(body) :]
            yield name, (number, begin, own)
            yield from _classes(number, inner, begin)


def _used(bodies: Mapping[str, list[Body]], name: str) -> Iterator[Body]:
    """The classes that can be reached by names, the model first."""
    seen, waiting = {name}, [name]
    while waiting:
        for body in bodies.get(waiting.pop(), []):
            yield body
            words = set(re.findall(r"\w+", body[2])) & bodies.keys() - seen
            seen |= words
            waiting += sorted(words)
