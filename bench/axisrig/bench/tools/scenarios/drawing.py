"""Inputs with places to draw: a cell of `machines.csv` to the inputs of one scenario.

A place in braces is drawn, everything beside it is taken as it is written:

    {300..1800}                       a whole number
    {0.100..0.400}                    a number with as many decimals as the finer end
    {300..1800 step 20 off 120 V.E.A} one of 300, 320 .. 1800, at least 120 beside that of V.E.A
    {a | b}                           one of these

`?0.2 COLUMN=VALUE ;; COLUMN=VALUE` at the end of a cell: these too, with this probability.
"""

import random
import re
from collections.abc import Mapping

from axisrig.kernel.errors import UserError

_PLACE = re.compile(r"\{([^{}]*)\}")
_RANGE = re.compile(
    r"(?P<low>-?[\d.]*\d)\.\.(?P<high>-?[\d.]*\d)"
    r"(?: step (?P<step>\d+) off (?P<off>\d+) (?P<of>\S+))?"
)
BETWEEN = " ;; "


def draw_inputs(cell: str, numbers: random.Random) -> list[str]:
    """Return the inputs of a cell as `COLUMN=VALUE`, drawn in the order of the places.

    Raises UserError for a place that is none of the forms.
    """
    always, _, sometimes = cell.partition("?")
    drawn: dict[str, str] = {}
    inputs = [_drawn(text, numbers, drawn) for text in _split(always)]
    if sometimes:
        share, _, rest = sometimes.partition(" ")
        if numbers.random() < float(share):
            inputs += [_drawn(text, numbers, drawn) for text in _split(rest)]
    return inputs


def _split(text: str) -> list[str]:
    return [part.strip() for part in text.split(BETWEEN.strip()) if part.strip()]


def _drawn(text: str, numbers: random.Random, drawn: dict[str, str]) -> str:
    whole = _PLACE.sub(lambda found: _place(found[1], numbers, drawn), text)
    column, _, value = whole.partition("=")
    drawn[column.rpartition(":")[2]] = value
    return whole


def _place(form: str, numbers: random.Random, drawn: Mapping[str, str]) -> str:
    if "|" in form:
        return numbers.choice([each.strip() for each in form.split("|")])
    found = _RANGE.fullmatch(form.strip())
    if found is None:
        raise UserError(
            "no such form of a place to draw", value=form, allowed="LOW..HIGH, or A | B"
        )
    low, high = found["low"], found["high"]
    if found["step"]:
        beside, off = int(drawn[found["of"]]), int(found["off"])
        far = [
            number
            for number in range(int(low), int(high) + 1, int(found["step"]))
            if abs(number - beside) >= off
        ]
        return str(numbers.choice(far))
    decimals = max(len(end.partition(".")[2]) for end in (low, high))
    if not decimals:
        return str(numbers.randint(int(low), int(high)))
    return f"{numbers.uniform(float(low), float(high)):.{decimals}f}"
