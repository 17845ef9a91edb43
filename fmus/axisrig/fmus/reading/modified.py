"""Modifiers that name nothing: the compiler leaves them out, and the model keeps its default.

Each name is looked for in the flattened class and in the text of the classes that are modified.
Source: behaviour of rumoca 0.10.2; Modelica language specification 3.6, 7.2 (modifications) and
4.9 (attributes of predefined types).
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches

from axisrig.fmus.reading.classes import KEYWORD
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.texts import SHORT, Class, Texts, inside

ATTRIBUTES = (
    "start", "fixed", "min", "max", "nominal", "unit", "displayUnit", "quantity", "stateSelect",
    "unbounded",
)  # fmt: skip
_PREFIX = re.compile(
    r"\s*(?:(?:public|protected|final|inner|outer|replaceable|redeclare|parameter|constant|discrete"
    r"|input|output|flow|stream|each)\b\s*)*"
)
_TYPED = re.compile(r"([A-Za-z_][\w.]*)\s*(?:\[[^\]]*\]\s*)?(?=[A-Za-z_])")
_NAMED = re.compile(r"([A-Za-z_]\w*)\s*(?:\[[^\]]*\]\s*)?")
_EXTENDS = re.compile(r"extends\s+([\w.]+)\s*")
_ELEMENT = re.compile(r"\s*(?:(?:each|final)\b\s*)*([A-Za-z_][\w.]*)\s*(?:\[[^\]]*\]\s*)?")
_CLASS = re.compile(rf"\b{KEYWORD}\s+(\w+)")
_INNER = re.compile(
    rf"\b(?:{KEYWORD}|operator)\s+(\w+)\b(?:(?!\s*=)[\s\S]*?\bend\s+\1\s*;|\s*=[^;]*;)"
)
_SECTION = re.compile(r"\b(?:initial\s+)?(?:equation|algorithm)\b")
_NO_TYPE = {
    "if", "for", "while", "when", "end", "import", "annotation", "extends", "connect", "assert",
    "return", "break", "then", "else", "elseif", "elsewhen", "loop", "in", "and", "or", "not",
    "within", "type", "model", "block", "class", "record", "connector", "package", "function",
    "partial", "encapsulated", "operator", "expandable", "pure", "impure", "external",
}  # fmt: skip


@dataclass(frozen=True)
class _Modified:
    """A list of modifiers. place: of its first character in `owner.text`. type_name: of what."""

    owner: Class
    place: int
    text: str
    path: str
    type_name: str


def refuse_unknown_modifiers(ir: Ir, texts: Texts) -> None:
    """Stop at a modifier whose name is none of what it modifies, in a class that the model uses.

    Raises BuildError with the place of the name and the nearest one.
    """
    _Check(ir, texts).walk(ir.model, "", set())


class _Check:
    def __init__(self, ir: Ir, texts: Texts) -> None:
        self._ir, self._texts = ir, texts
        self._flat = {re.sub(r"\[[^\]]*\]", "", name) for name in ir.flat["variables"]}
        self._below: dict[str, set[str]] = {}  # path -> names one step below it
        for name in self._flat:
            steps = name.split(".")
            for count, step in enumerate(steps):
                self._below.setdefault(".".join(steps[:count]), set()).add(step)
        self._parts: dict[str, list[_Modified]] = {}

    def walk(self, name: str, path: str, seen: set[tuple[str, str]]) -> None:
        """Look at the modifiers of a class that stands at `path` in the model, and of its parts."""
        found = self._texts.get(name)
        if found is None or (name, path) in seen:
            return
        seen.add((name, path))
        for part in self._parts_of(found):
            at = f"{path}.{part.path}".strip(".")
            target = self._texts.resolve(part.type_name, found.name)
            self._look(part, at, target)
            if target is not None and target.name != name:
                self.walk(target.name, at, seen)

    def _look(self, part: _Modified, path: str, target: Class | None) -> None:
        if path and not self._reaches(path):
            return  # a part that a condition leaves out, or one without variables
        for offset, element in _split(part.text):
            named = _ELEMENT.match(element)
            if named is None or named[1] in ("redeclare", "replaceable"):
                continue
            name, at = named[1], f"{path}.{named[1]}".strip(".")
            if not self._reaches(at) and name not in (known := self._members(path, target)):
                raise self._error(part, offset + named.start(1), name, known)
            rest = element[named.end() :]
            if rest.startswith("("):
                inner = inside(element, named.end() + 1)
                begin = part.place + offset + named.end() + 1
                kind = self._component(target, name)
                self._look(_Modified(part.owner, begin, inner, at, ""), at, kind)

    def _reaches(self, path: str) -> bool:
        return path in self._flat or path in self._below

    def _parts_of(self, found: Class) -> list[_Modified]:
        if found.name not in self._parts:
            self._parts[found.name] = list(_parts(found))
        return self._parts[found.name]

    def _members(self, path: str, target: Class | None) -> list[str]:
        """Names that a modifier may have at a path: of a variable, attributes."""
        if path in self._flat:
            return list(ATTRIBUTES)
        known = set(self._below.get(path, ()))
        if target is not None:
            for base in self._texts.bases(target.name):
                known |= {part.path for part in self._parts_of(base)}
                known |= set(_CLASS.findall(base.code))
        return sorted(known - {""})

    def _component(self, target: Class | None, name: str) -> Class | None:
        """The class of a part of a class."""
        for base in self._texts.bases(target.name) if target else ():
            for part in self._parts_of(base):
                if part.path == name:
                    return self._texts.resolve(part.type_name, base.name)
        return None

    def _error(self, part: _Modified, offset: int, name: str, known: list[str]) -> BuildError:
        where = part.place + offset
        message = f"there is no {name} to modify"
        if part.type_name:
            message += f" in {part.type_name}"
        near = get_close_matches(name, known, 3)
        if near:
            message += f"; did you mean {' or '.join(near)}"
        for number, (_, text) in self._ir.files.items():
            begin = text.find(part.owner.text)
            if begin >= 0:
                start = len(text[: begin + where].encode())
                return self._ir.error({"source": number, "start": start}, message)
        return BuildError(self._ir.model, None, message)


def _parts(found: Class) -> Iterator[_Modified]:
    """Base classes and components of a class with their modifiers; the path of a base is ''."""
    code = found.code
    head = re.match(r"\w+\s+\w+", code)
    short = head and SHORT.match(code, head.end())
    if short:
        if found.keyword in ("model", "block", "class"):
            opened = re.compile(r"\s*\(").match(code, short.end())
            text = inside(code, opened.end()) if opened else ""
            yield _Modified(found, opened.end() if opened else 0, text, "", short[1])
        return
    body = _without_inner(code)
    section = _SECTION.search(body)
    body = body[: section.start() if section else len(code)]
    for begin, statement in _split(body, ";"):
        at = _PREFIX.match(statement).end()  # type: ignore[union-attr]
        if extends := _EXTENDS.match(statement, at):
            yield _list(found, begin, statement, extends.end(), "", extends[1])
            continue
        typed = _TYPED.match(statement, at)
        if typed is None or typed[1] in _NO_TYPE:
            continue
        rest = typed.end()
        for offset, one in _split(statement[rest:]):
            named = _NAMED.match(one.lstrip())
            if named is not None:
                start = rest + offset + len(one) - len(one.lstrip())
                yield _list(found, begin, statement, start + named.end(), named[1], typed[1])


def _list(
    found: Class, begin: int, statement: str, end: int, path: str, type_name: str
) -> _Modified:
    text = inside(statement, end + 1) if statement[end : end + 1] == "(" else ""
    return _Modified(found, begin + end + 1, text, path, type_name)


def _without_inner(code: str) -> str:
    """Blank classes inside a class, and its head.

    A class in brackets is redeclared by a modifier, and others follow it in its list.
    """
    head = re.match(r"\w+\s+\w+", code)
    begin = head.end() if head else 0
    rest = code[begin:]

    def blank(found: re.Match[str]) -> str:
        before = rest[: found.start()]
        is_modifier = before.count("(") > before.count(")")
        return found[0] if is_modifier else re.sub(r"[^\n]", " ", found[0])

    return re.sub(r"[^\n]", " ", code[:begin]) + _INNER.sub(blank, rest)


def _split(text: str, sign: str = ",") -> Iterator[tuple[int, str]]:
    """Pieces of a text between signs outside brackets, with the offset of each."""
    depth, begin = 0, 0
    for place, letter in enumerate(text):
        depth += {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}.get(letter, 0)
        if letter == sign and depth == 0:
            yield begin, text[begin:place]
            begin = place + 1
    if text[begin:].strip():
        yield begin, text[begin:]
