"""Modifiers that the compiler drops without a word, found in the text of a model.

Source: behaviour of rumoca 0.10.2. Of `redeclare model M = C(k = 5)` and of
`replaceable model M = C constrainedby B(k = 6)` the values in brackets have no effect. Those of
`replaceable C c constrainedby B(k = 6)` act on what `c` is redeclared to, but not on C itself.
`redeclare` has no effect inside the modifier of a modifier, nor in `extends B(redeclare D c)` where
B inherits `c`.
"""

import re
from collections.abc import Iterator, Mapping
from typing import Any

from axisrig.fmus.reading.classes import KEYWORD, used_classes
from axisrig.fmus.reading.ir import Ir, Source

_REDECLARED = re.compile(
    rf"\bredeclare\s+(?:(?:final|replaceable)\s+)*{KEYWORD}\s+\w+\s*=\s*[\w.]+\s*\("
)
_CONSTRAINED = re.compile(r"\breplaceable\b([^;]*?)\bconstrainedby\s+[\w.]+\s*\(([^;]*)")
_MODIFIED = re.compile(r"(\w+)\s*=")
_REDECLARE = re.compile(
    rf"\bredeclare\s+(?:(?:final|replaceable)\s+)*(?:{KEYWORD}\s+(\w+)\s*=|[\w.]+\s+(\w+))"
)


def refuse_dropped_modifiers(ir: Ir) -> None:
    """Stop at such a modifier in a class that the model uses.

    Raises BuildError with the place of the modifier.
    """
    files = {number: text for number, (_, text) in ir.files.items()}
    bodies = list(used_classes(files, ir.model))
    texts: dict[str, str] = {}
    for body in bodies:
        name = re.match(r"\w*", body.text)[0]  # type: ignore[index]
        texts[name] = texts.get(name, "") + body.text
    for body in bodies:
        for place, message in _dropped(body.text, texts):
            start = len(files[body.number][: body.offset + place].encode())
            raise ir.error({"source": body.number, "start": start}, message)


def _dropped(text: str, classes: Mapping[str, str]) -> Iterator[tuple[int, str]]:
    """Where a modifier is that has no effect, and what to say; classes: text by name."""
    of_class = (
        "the compiler drops the modifier of a class in redeclare and constrainedby;"
        " modify the component instead"
    )
    found = _REDECLARED.search(text)
    if found:
        yield found.start(), of_class
    for constrained in _CONSTRAINED.finditer(text):
        own, wanted = constrained.groups()
        is_class = re.match(rf"\s*{KEYWORD}\b", own) is not None
        if is_class or not set(_MODIFIED.findall(wanted)) <= set(_MODIFIED.findall(own)):
            yield constrained.start(), of_class
    for redeclare in _REDECLARE.finditer(text):
        before = text[text.rfind(";", 0, redeclare.start()) + 1 : redeclare.start()]
        if before.count("(") - before.count(")") > 1:
            yield (
                redeclare.start(),
                "the compiler drops redeclare inside the modifier of a modifier;"
                " redeclare in a class of its own",
            )
        base = re.search(r"\bextends\s+(?:\w+\.)*(\w+)\s*\(", before)
        name = redeclare.group(1) or redeclare.group(2)
        declared = rf"\breplaceable\b[^;(]*\b{name}\b"
        if base and not re.search(declared, classes.get(base.group(1), "")):
            yield (
                redeclare.start(),
                f"the compiler drops redeclare of {name}, which {base.group(1)} inherits;"
                " extend the class that declares it",
            )


def shared_numbers(ir: Ir) -> Iterator[tuple[int, int, Source | None]]:
    """Parameters that must follow another one: their slot in p, that of the other, the place.

    Of `A a(k = 5)` with `B b(k = k)` in A the compiler binds a.b.k to the number, not to a.k. Both
    then have the same piece of text, which is not the declaration of either.
    """
    groups: dict[tuple[object, ...], dict[str, Mapping[str, Any]]] = {}
    elements = {}
    for variable in ir.dae["variables"]:
        span = _number_from_outside(ir, variable)
        if span is not None:
            shape = tuple(variable["value_type"]["dimensions"])
            group = groups.setdefault((span["source"], span["start"], shape), {})
            group[variable["name"]] = span
            elements[variable["name"]] = variable["scalar_names"]
    slots = ir.solve["layout"]["bindings"]
    for group in groups.values():
        for name, span in group.items():
            inside, _, last = name.rpartition(".")
            outer = [
                other
                for other in group
                if other.rpartition(".")[2] == last
                and inside.startswith(f"{other.rpartition('.')[0]}.".removeprefix("."))
                and other.count(".") < name.count(".")
            ]
            if outer:
                nearest = max(outer, key=len)
                for own, other in zip(elements[name], elements[nearest], strict=True):
                    yield slots[own]["P"]["index"], slots[other]["P"]["index"], ir.place(span)


def _number_from_outside(ir: Ir, variable: Mapping[str, Any]) -> Mapping[str, int] | None:
    """The span of a parameter's number when a modifier gives it, None for its own declaration."""
    binding = variable["attributes"]["binding"]
    slots = ir.solve["layout"]["bindings"]
    rests = all("P" in slots.get(name, {}) for name in variable["scalar_names"])
    if variable["role"] != "parameter" or binding is None or not rests:
        return None
    expression = ir.dae["expressions"][binding]
    span: Mapping[str, int] | None = expression["provenance"].get("span")
    own = variable["declaration"].get("span")
    if expression["variability"] != "constant" or span is None or span["source"] not in ir.files:
        return None
    if own is not None and own["source"] == span["source"] and own["start"] <= span["start"]:
        text = ir.files[span["source"]][1].encode()[own["start"] : span["start"]]
        return span if b";" in text else None
    return span
