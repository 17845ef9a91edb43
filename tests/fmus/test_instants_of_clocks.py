"""sample() with times that are constant: its instants as whole numbers of one divisor."""

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations.clocks import _Reader
from axisrig.fmus.reading.errors import BuildError


@pytest.mark.parametrize(
    ("phase", "period"),
    [("0", "1/1000"), ("1/3", "1/5"), ("1/4", "1/4"), ("1/4", "1/6"), ("3", "2"), ("7/9", "1/12")],
)
def test_instants_of_a_clock_are_whole_numbers_of_one_divisor(phase: str, period: str) -> None:
    found = schedule(Fraction(phase), Fraction(period))
    assert found.grid is not None
    begin, step, divisor = found.grid
    for number in range(5):
        instant = Fraction(phase) + number * Fraction(period)
        assert Fraction(begin + number * step, divisor) == instant
    assert (found.offset.value, found.interval.value) == (
        float(Fraction(phase)), float(Fraction(period)),
    )  # fmt: skip


def test_instants_that_are_too_fine_for_a_double_are_refused() -> None:
    assert schedule(Fraction(0), Fraction(1, 2**52)).grid == (0, 1, 2**52)
    with pytest.raises(BuildError, match="too fine"):
        schedule(Fraction(0), Fraction(1, 2**53))


@pytest.mark.parametrize("name", ["phase", "period"])
def test_each_whole_number_of_a_grid_is_exact_in_a_double(name: str) -> None:
    """2^53 is the first one that has a neighbour which is not."""

    def grid(number: int) -> Any:
        return schedule(
            **({"phase": Fraction(1), "period": Fraction(1)} | {name: Fraction(number)})
        ).grid

    assert max(grid(2**53 - 1)) == 2**53 - 1
    with pytest.raises(BuildError, match="too fine"):
        grid(2**53)


def schedule(phase: Fraction, period: Fraction) -> Any:
    parts = {"phase": phase, "period": period}
    lattice = {
        name: {"num": part.numerator, "den": part.denominator} for name, part in parts.items()
    }
    clock = {"operation": {"kind": "periodic", "anchor": "absolute", "lattice": lattice}}
    systems = {"conditions": {"conditions": []}, "clocks": {"clocks": [clock]}}
    ir: Any = SimpleNamespace(
        dae={"systems": systems}, files={}, place=lambda _span: None,
        error=lambda _span, message: BuildError("M", None, message),
    )  # fmt: skip
    condition = {"operation": {"clock": 0}, "provenance": {}}
    return _Reader(ir, 0)._schedule(condition, "")
