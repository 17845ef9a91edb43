"""Where a statement, a list and a sample() of a source begin and end."""

from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations.clocks import _Reader
from axisrig.fmus.reading.calls import _statement
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.modified import _split


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("a=1, b=2", ["a=1", " b=2"]), ("a(x=1, y=2), b", ["a(x=1, y=2)", " b"]),
        ("a={1, {2, 3}}, b[1, 2]=3", ["a={1, {2, 3}}", " b[1, 2]=3"]),
        ("a(b(c=1, d={1, 2}), e)", ["a(b(c=1, d={1, 2}), e)"]), ("", []), ("  ", []),
        ("a, ", ["a"]), ("a,,b", ["a", "", "b"]),
    ],
)  # fmt: skip
def test_a_list_is_divided_outside_its_brackets_alone(text: str, parts: list[str]) -> None:
    found = list(_split(text))
    assert [part for _, part in found] == parts
    assert all(text[begin:].startswith(part) for begin, part in found)


SOURCE = """model M
  Real u = f(1); // \u00e4
equation
  x = {g(i) for i in 1:3}; y = h(2);
  for i in 1:2 loop
    z[i] = k(i);
    w[i] = k(2);
  end for;
  v = {{m(i, j) for i in 1:2} for j in 1:2} * q(";");
algorithm
  if a then b := r(1); else b := s(1); end if;
end M;
"""


@pytest.mark.parametrize(
    ("call", "statement"),
    [
        ("f(1)", "Real u = f(1)"), ("g(i)", "x = {g(i) for i in 1:3}"), ("h(2)", "y = h(2)"),
        ("m(i, j)", 'v = {{m(i, j) for i in 1:2} for j in 1:2} * q(";")'),
        ("r(1)", "b := r(1)"), ("s(1)", "b := s(1)"),
        ("1:2 loop", "for i in 1:2 loop z[i] = k(i); w[i] = k(2); end for"),
    ],
)  # fmt: skip
def test_a_statement_goes_from_one_semicolon_to_its_own(call: str, statement: str) -> None:
    """A loop is whole; `for` inside an array, and a semicolon in a text, end nothing."""
    text = SOURCE.encode()
    begin = text.index(call.encode())
    span = {"source": 1, "start": begin, "end": begin + len(call)}
    ir: Any = SimpleNamespace(files={1: (Path("M.mo"), SOURCE)})
    first, last = _statement(ir, span)
    found = " ".join(text[first:last].decode().split())
    assert found.endswith(statement)
    assert found.removesuffix(statement).strip() in ("", "model M")
    assert _statement(ir, span | {"source": 2}) == (0, 0)


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
