"""`-k EXPR`: choosing cases by words in their name, joined by and, or, not and brackets.

An expression that is the whole name of a case means that case alone.
"""

import re
from collections.abc import Sequence

from axisrig.bench.plan.case import Case
from axisrig.kernel.errors import UserError

_TOKEN = re.compile(r"\(|\)|[^\s()]+")


def chosen(cases: Sequence[Case], expression: str) -> tuple[Case, ...]:
    """Return the cases that fit, in their order: that of the name alone, else all that fit.

    Raises UserError for an expression that cannot be read.
    """
    exact = tuple(case for case in cases if expression in (case.case, case.run))
    return exact or tuple(case for case in cases if matches(expression, case))


def only(cases: Sequence[Case], expression: str) -> Case:
    """Return the one case that fits. Raises UserError where none does or several do."""
    found = chosen(cases, expression)
    if len(found) != 1:
        raise UserError(
            f"-k {expression!r} has to name one case, {len(found)} fit",
            allowed=[case.run for case in found or cases],
        )
    return found[0]


def matches(expression: str, case: Case) -> bool:
    """Return whether a case fits: a word fits when it is part of the run id, a tag or the title.

    Raises UserError for an expression that cannot be read.
    """
    text = " ".join([case.run, *case.tags, case.title]).lower()
    tokens = _TOKEN.findall(expression.lower())
    value, rest = _either(tokens, text, expression)
    if rest:
        raise _unreadable(expression, rest[0])
    return value


def _either(tokens: list[str], text: str, whole: str) -> tuple[bool, list[str]]:
    value, tokens = _both(tokens, text, whole)
    while tokens and tokens[0] == "or":
        other, tokens = _both(tokens[1:], text, whole)
        value = value or other
    return value, tokens


def _both(tokens: list[str], text: str, whole: str) -> tuple[bool, list[str]]:
    value, tokens = _single(tokens, text, whole)
    while tokens and tokens[0] == "and":
        other, tokens = _single(tokens[1:], text, whole)
        value = value and other
    return value, tokens


def _single(tokens: list[str], text: str, whole: str) -> tuple[bool, list[str]]:
    if not tokens or tokens[0] in ("and", "or", ")"):
        raise _unreadable(whole, tokens[0] if tokens else "the end")
    first, rest = tokens[0], tokens[1:]
    if first == "not":
        value, rest = _single(rest, text, whole)
        return not value, rest
    if first == "(":
        value, rest = _either(rest, text, whole)
        if not rest or rest[0] != ")":
            raise _unreadable(whole, rest[0] if rest else "the end")
        return value, rest[1:]
    return first in text, rest


def _unreadable(expression: str, at: str) -> UserError:
    return UserError(
        f"-k {expression!r} cannot be read at {at!r}", allowed="words, and, or, not, brackets"
    )
