"""How to write what a cell holds in the notation of another program: ranges, lists, conditions."""

import re
from decimal import Decimal

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_COLONS = re.compile(rf"({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*({_NUMBER})")
_SIGNS = {
    "≤": "<=",
    "≥": ">=",
    "≠": "!=",
    "=<": "<=",
    "=>": ">=",
    "<>": "!=",
    "…": "..",
    "...": "..",
}
_MINUS = re.compile(r"(?<![\d.])(?<![\d.] )[–−]")
"""Signs of other notations in conditions, longer ones before their parts -> what is meant."""


def several_hint(text: str) -> str | None:
    """Return how several numbers are written in a cell of values; None for anything else."""
    if match := _COLONS.fullmatch(text):
        return _range_hint(*match.groups())
    words = re.split(r"[\s,;/]+", text)
    if len(words) > 1 and all(re.fullmatch(_NUMBER, word) for word in words):
        return f"several values are a list with bars: [{' | '.join(words)}]"
    return None


def _range_hint(first: str, second: str, third: str) -> str | None:
    """Write `first:last:step`, or where that leads nowhere `first:step:last`, as a range."""
    for last, step in ((second, third), (third, second)):
        way, width = Decimal(last) - Decimal(first), Decimal(step)
        if way * width > 0 and way % width == 0:
            return f"a range is written with its step: {first} .. {last} step {step}"
    return "a range is written with its step: 300 .. 3000 step 300"


def condition_hint(text: str) -> str | None:
    """Return how a condition is written that other signs or a decimal comma spoil."""
    if re.search(r"\d,\d", text):
        return "a decimal point, not a comma"
    if text.lower() in ("true", "false"):
        return f"write == {text.upper()}"
    meant = _MINUS.sub("-", text)
    for sign, own in _SIGNS.items():
        meant = meant.replace(sign, f" {own} ")
    return None if meant == text else f"write {' '.join(meant.split())}"
