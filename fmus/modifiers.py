"""Modifiers that the compiler drops without a word, found in the text of a model.

Source: behaviour of rumoca 0.10.2. Of `redeclare model M = C(k = 5)` and of
`replaceable model M = C constrainedby B(k = 6)` the values in brackets have no effect. Those of
`replaceable C c constrainedby B(k = 6)` act on what `c` is redeclared to, but not on C itself.
"""

import re

from fmus.classes import KEYWORD, used_classes
from fmus.ir import Ir

_REDECLARED = re.compile(
    rf"\bredeclare\s+(?:(?:final|replaceable)\s+)*{KEYWORD}\s+\w+\s*=\s*[\w.]+\s*\("
)
_CONSTRAINED = re.compile(r"\breplaceable\b([^;]*?)\bconstrainedby\s+[\w.]+\s*\(([^;]*)")
_MODIFIED = re.compile(r"(\w+)\s*=")


def refuse_dropped_modifiers(ir: Ir) -> None:
    """Stop at such a modifier in a class that the model uses.

    Raises BuildError with the place of the modifier.
    """
    files = {number: text for number, (_, text) in ir.files.items()}
    for body in used_classes(files, ir.model):
        place = _dropped(body.text)
        if place is not None:
            start = len(files[body.number][: body.offset + place].encode())
            message = (
                "the compiler drops the modifier of a class in redeclare and constrainedby;"
                " modify the component instead"
            )
            raise ir.error({"source": body.number, "start": start}, message)


def _dropped(text: str) -> int | None:
    """Where a modifier stands that has no effect."""
    found = _REDECLARED.search(text)
    if found:
        return found.start()
    for constrained in _CONSTRAINED.finditer(text):
        own, wanted = constrained.groups()
        is_class = re.match(rf"\s*{KEYWORD}\b", own) is not None
        if is_class or not set(_MODIFIED.findall(wanted)) <= set(_MODIFIED.findall(own)):
            return constrained.start()
    return None
