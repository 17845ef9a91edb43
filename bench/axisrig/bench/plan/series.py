"""Series of numbers that a cell stands for: ranges, equal ratios, boundary values."""

import re
from collections.abc import Callable
from decimal import Context, Decimal, localcontext

from axisrig.bench.plan.table import Cell

RUNS_MAX = 100_000
FORMS = (
    "[a | b], 300 .. 3000 step 300, log(1, 100, 5), boundary(300, 3000, 1), pairwise(a | b),"
    " lhs(0, 1), sobol(0, 1), normal(0, 1)"
)

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\s*\.\.\s*({_NUMBER})(?:\s+step\s+({_NUMBER}))?")
_DIGITS = 10
"""Digits of values that are no ends: as many as a cell can show, more than any input needs."""


def decimals(cell: Cell, make: Callable[..., tuple[str, ...]], *arguments: str) -> tuple[str, ...]:
    """Return what `make` gives for a cell. Raises UserError for numbers without a Decimal."""
    try:
        return make(cell, *arguments)
    except ArithmeticError as error:  # an exponent that no Decimal has
        raise cell.place.error("a number is too large or too small", value=cell.text) from error


def range_values(cell: Cell) -> tuple[str, ...]:
    """Give the values of `a .. b step s`, both ends."""
    match = _RANGE.fullmatch(cell.text)
    if match is None:
        raise cell.place.error("the range cannot be read", value=cell.text, allowed=FORMS)
    if match[3] is None:
        raise cell.place.error(
            "a range of values needs a step",
            value=cell.text,
            hint=f"{cell.text} step ...; without it it is a condition, which belongs in check:",
        )
    first, last, step = (Decimal(part) for part in match.groups())
    if step == 0 or (last - first) * step < 0:
        raise cell.place.error(
            "the step does not lead from the first value to the last", value=cell.text
        )
    count = (last - first) / step
    if count != count.to_integral_value():
        nearest_end = first + step * count.to_integral_value("ROUND_FLOOR")
        raise cell.place.error(
            "the range does not end with a whole step",
            value=cell.text,
            hint=f"the last step before it ends at {plain(nearest_end)}",
        )
    if count >= RUNS_MAX:
        raise cell.place.error(too_many(plain(count + 1)), value=cell.text)
    return tuple(plain(first + step * number) for number in range(int(count) + 1))


def log_values(cell: Cell, first: str, last: str, count: str) -> tuple[str, ...]:
    """Give values with equal ratios, both ends; 10 digits inside."""
    low, high = Decimal(first), Decimal(last)
    if low <= 0 or high <= 0 or low == high:
        raise cell.place.error(
            "the ends of log(...) are two different numbers above 0", value=cell.text
        )
    if not re.fullmatch(r"\d{1,6}", count) or not 2 <= int(count) <= RUNS_MAX:
        raise cell.place.error(
            "log(...) needs a whole number of values, 2 or more", value=cell.text
        )
    inside = int(count) - 1
    with localcontext(Context(prec=40)):  # the same digits on every machine
        ratio = (high.ln() - low.ln()) / inside
        values = [(low.ln() + ratio * number).exp() for number in range(1, inside)]
    rounding = Context(prec=_DIGITS)
    return (plain(low), *(plain(rounding.plus(value)) for value in values), plain(high))


def boundary_values(cell: Cell, first: str, last: str, step: str) -> tuple[str, ...]:
    """Give both ends, the values one step inside them, and the middle."""
    low, high, width = Decimal(first), Decimal(last), Decimal(step)
    if width <= 0 or high - low < 2 * width:
        raise cell.place.error(
            "boundary(first, last, step) needs a step above 0 that fits in twice", value=cell.text
        )
    inside = Context(prec=_DIGITS).divide(low + high, Decimal(2))
    values = (low, low + width, inside, high - width, high)
    return tuple(dict.fromkeys(plain(value) for value in values))


def plain(value: Decimal) -> str:
    """Write a number without trailing zeros and without an exponent where it is of some size."""
    if value == 0:
        return "0"
    value = value.normalize()
    return f"{value:f}" if -_DIGITS <= value.adjusted() <= _DIGITS else f"{value}"


def number_text(value: float) -> str:
    """Write a drawn value with ten digits."""
    return plain(Context(prec=_DIGITS).create_decimal(value))


def too_many(count: int | str) -> str:
    """Say that runs are too many. count: as it is shown."""
    return f"{count} runs are more than {RUNS_MAX}"
