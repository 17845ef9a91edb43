"""Classes in the text of a Modelica library, as far as places of messages need them."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

KEYWORD = r"(?:model|block|class|record|connector|package|function|type)"
_HEAD = re.compile(rf"\b{KEYWORD}\s+(\w+)(?!\w)(?!\s*=)")
# Comments and strings, also the HTML of the documentation.
_NO_CODE = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|/\*.*?\*/', re.DOTALL)


@dataclass(frozen=True)
class Body:
    """A class from its name on.

    number: of the file. offset: of the first character in it. text: with blanks in place of
    comments, strings and inner classes.
    """

    number: int
    offset: int
    text: str


def used_classes(files: Mapping[int, str], model: str) -> Iterator[Body]:
    """The classes that a model (full name) can reach, itself first.

    A class counts as reached when its name is in one that is; files: text by number.
    """
    bodies: dict[str, list[Body]] = {}
    for number, text in files.items():
        for name, body in _classes(number, _NO_CODE.sub(_blank, text), 0):
            bodies.setdefault(name, []).append(body)
    name = model.rpartition(".")[2]
    seen, waiting = {name}, [name]
    while waiting:
        for body in bodies.get(waiting.pop(0), []):
            yield body
            words = set(re.findall(r"\w+", body.text)) & bodies.keys() - seen
            seen |= words
            waiting += sorted(words)


def class_names(text: str) -> list[str]:
    """The names of the classes of a text, without inner ones."""
    code, names, position = _NO_CODE.sub(_blank, text), [], 0
    while head := _HEAD.search(code, position):
        names.append(head[1])
        end = re.compile(rf"\bend\s+{head[1]}\s*;").search(code, head.end())
        position = len(code) if end is None else end.end()
    return names


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match.group(0))


def _classes(number: int, text: str, offset: int) -> Iterator[tuple[str, Body]]:
    """Every class of a text, inner ones on their own."""
    position = 0
    while head := _HEAD.search(text, position):
        name = head.group(1)
        end = re.compile(rf"\bend\s+{name}\s*;").search(text, head.end())
        position = head.end() if end is None else end.end()
        if end is not None:
            begin = head.start(1)
            inner = own = text[begin : end.start()]
            for _, body in _classes(number, inner, offset + begin):
                at = body.offset - offset - begin
                own = own[:at] + " " * len(body.text) + own[at + len(body.text) :]
            yield name, Body(number, offset + begin, own)
            yield from _classes(number, inner, offset + begin)
