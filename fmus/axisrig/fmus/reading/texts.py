"""What the compiler leaves out of a library: types with names, experiments, documentation, icons.

The text of each class is found by its full name. Source: Modelica language specification 3.6,
chapters 5 (names), 13 (packages) and 18 (annotations).
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from axisrig.fmus.reading.classes import KEYWORD
from axisrig.fmus.reading.ir import Ir

_WITHIN = re.compile(r"\s*within\s*([\w.]*)\s*;")
_HEAD = re.compile(rf"^\s*(?:(?:partial|final|encapsulated)\s+)*({KEYWORD})\s+(\w+)(?!\w)", re.M)
SHORT = re.compile(r"\s*=\s*(?:(?:input|output)\s+)?([\w.]+)")
_STRING = re.compile(r'"((?:[^"\\]|\\.)*)"', re.DOTALL)
_NO_CODE = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
# A component or a base class: its type, at the beginning of a declaration
_USED = re.compile(
    r"^\s*(?:extends|(?:inner|outer|replaceable|final|parameter|input|output)\s)*\s*"
    r"([A-Za-z_]\w*(?:\.\w+)*)\s*(?:\([^;]*\))?\s*(?:\w+|;)",
    re.M,
)
_NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
# Attributes of a type that a description can carry, and how the language writes their values
_ATTRIBUTES: Mapping[str, str] = {
    "quantity": r'"([^"]*)"',
    "unit": r'"([^"]*)"',
    "displayUnit": r'"([^"]*)"',
    "nominal": rf"({_NUMBER})",
}


@dataclass(frozen=True)
class Class:
    """A class of a library. name: in full. keyword: model, type, ... text: all of it."""

    name: str
    keyword: str
    text: str

    @property
    def code(self) -> str:
        """The text with blanks in place of comments and strings; as long as the text."""
        return _without_words(self.text)

    @property
    def title(self) -> str:
        """The description after the name of a class that has a body, without line breaks."""
        found = re.match(rf"{KEYWORD}\s+\w+\s*", self.text)
        title = found and _STRING.match(self.text, found.end())
        return " ".join(_plain(title[1]).split()) if title else ""

    def annotation(self, name: str) -> str:
        """What is in the parentheses of an annotation such as `experiment(...)`, else ''."""
        for found in re.finditer(rf"\b{name}\s*\(", self.code):
            return self.text[found.end() : found.end() + len(inside(self.code, found.end()))]
        return ""

    def documentation(self) -> str:
        """The body of the HTML text of `Documentation(info="...")`, else ''."""
        found = re.search(r"\binfo\s*=\s*", self.annotation("Documentation"))
        text = found and _STRING.match(self.annotation("Documentation"), found.end())
        body = re.sub(r"</?html>", "", _plain(text[1])) if text else ""
        return body.strip()


class Texts:
    """The classes of every file that the compiler has read."""

    def __init__(self, ir: Ir) -> None:
        self._classes: dict[str, Class] = {}
        self._tops: dict[int, str] = {}
        for number, (_, text) in ir.files.items():
            within = _WITHIN.match(_without_words(text))
            package = within[1] if within else ""
            for found in _classes(text, package):
                self._tops.setdefault(number, found.name)
                self._classes.setdefault(found.name, found)

    def get(self, name: str) -> Class | None:
        """The class of a full name."""
        return self._classes.get(name)

    def resolve(self, word: str, scope: str) -> Class | None:
        """The class that a name means in the class `scope`: the innermost package that has it."""
        while True:
            found = self._classes.get(f"{scope}.{word}" if scope else word)
            if found is not None or not scope:
                return found
            scope = scope.rpartition(".")[0]

    def declared_type(self, ir: Ir, variable: Mapping[str, Any]) -> Class | None:
        """The class that the declaration of a variable of the compiler names, None for Real.

        A connector that is an input or an output of a type counts as this type.
        """
        span = variable["declaration"].get("span")
        if span is None or span["source"] not in self._tops:
            return None
        text = ir.files[span["source"]][1].encode()[span["start"] : span["end"]].decode()
        word = re.match(r"[\w.]+", text)
        found = self.resolve(word[0], self._tops[span["source"]]) if word else None
        while found is not None and found.keyword == "connector":
            found = self._made_from(found)
        return found

    def _made_from(self, kind: Class) -> Class | None:
        """The class that a short definition such as `type A = B` names; None for Real."""
        head = re.match(rf"{KEYWORD}\s+\w+", kind.text)
        base = head and SHORT.match(kind.text, head.end())
        source = self.resolve(base[1], kind.name.rpartition(".")[0]) if base else None
        return source if source is not None and source.name != kind.name else None

    def attributes(self, kind: Class) -> dict[str, str]:
        """The attributes of a type, those of the types that it is made from included."""
        source = self._made_from(kind)
        found = self.attributes(source) if source is not None else {}
        for name, value in _ATTRIBUTES.items():
            given = re.search(rf"\b{name}\s*=\s*{value}", kind.text)
            if given:
                found[name] = given[1]
        return found

    def bases(self, model: str) -> list[Class]:
        """The class and the classes that it extends, itself first, each once."""
        found: dict[str, Class] = {}
        waiting = [self._classes.get(model)]
        while waiting:
            one = waiting.pop(0)
            if one is not None and one.name not in found:
                found[one.name] = one
                words = re.findall(r"\bextends\s+([\w.]+)", one.code)
                waiting += [self.resolve(word, one.name) for word in words]
        return list(found.values())

    def used(self, model: str) -> Iterator[Class]:
        """The model, then its base classes and the classes of its parts, each once.

        Functions and types are left out, and what only other classes than these use.
        """
        waiting, seen = [model], {model}
        while waiting:
            found = self._classes.get(waiting.pop(0))
            if found is None:
                continue
            yield found
            for word in _USED.findall(found.code):
                part = self.resolve(word, found.name)
                if part and part.name not in seen and part.keyword in ("model", "block"):
                    seen.add(part.name)
                    waiting.append(part.name)


def _classes(text: str, package: str) -> Iterator[Class]:
    """The classes of a text, inner ones after the one that holds them."""
    code = _without_words(text)
    position = 0
    while head := _HEAD.search(code, position):
        name = f"{package}.{head[2]}" if package else head[2]
        is_short = SHORT.match(code, head.end())
        pattern = r";" if is_short else rf"\bend\s+{head[2]}\s*;"
        end = re.compile(pattern).search(code, head.end())
        stop = len(text) if end is None else end.end()
        yield Class(name, head[1], text[head.start(1) : stop])
        if not is_short:
            yield from _classes(text[head.end() : stop], name)
        position = stop


def inside(code: str, begin: int) -> str:
    """The text from `begin` to the parenthesis that closes what was open there."""
    depth = 1
    for place in range(begin, len(code)):
        depth += {"(": 1, ")": -1}.get(code[place], 0)
        if depth == 0:
            return code[begin:place]
    return ""


def _without_words(text: str) -> str:
    """A text with blanks in place of comments and strings, as long as it was."""
    return _NO_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def _plain(text: str) -> str:
    """The characters that a string of the language means."""
    return re.sub(r"\\(.)", r"\1", text, flags=re.DOTALL)
