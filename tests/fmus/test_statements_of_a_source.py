"""Where a statement of a source, and a part of a list in it, begin and end."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.calls import _statement
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
  Real u = f(1); // \u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4\u00e4
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
