"""Names of the slots of p in a C source: each stands at the place of its index."""

import re
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import apply, const, parameter, variable
from axisrig.fmus.writing.source import _Source


def source(bindings: dict[str, tuple[str, int]], **given: Any) -> _Source:
    empty: dict[str, Any] = {name: [] for name in (
        "derivatives", "algebraics", "initial", "runtime", "updates", "whens", "conditions",
        "previous", "relations", "actions", "reinits", "schedules", "blocks",
    )}  # fmt: skip
    layout = {name: {vector: {"index": at}} for name, (vector, at) in bindings.items()}
    ir: Any = SimpleNamespace(solve={"layout": {"bindings": layout}})
    return _Source(ir, SimpleNamespace(**(empty | {"state_count": 0} | given)))  # type: ignore[arg-type]


@pytest.mark.parametrize("count", [1, 9, 10, 11, 12, 101])
def test_slots_are_in_the_order_of_their_indices(count: int) -> None:
    """Also from the tenth on, where texts would sort in another way, whatever the names are."""
    names = {f"{'zyx'[at % 3]}.v[{at}]": ("P", at) for at in reversed(range(count))}
    found = source(names).slots
    assert [index for _, index in found] == list(range(count))
    assert [name for name, _ in found] == [f"P{at}_{'zyx'[at % 3]}_v_{at}_" for at in range(count)]


def test_names_that_differ_in_signs_alone_have_slots_of_their_own() -> None:
    """And variables of y are no slots of p."""
    names = {"a.b": ("P", 1), "a_b": ("P", 0), "a[b]": ("P", 2), "x": ("Y", 0), "u": ("Y", 1)}
    assert source(names).slots == [("P0_a_b", 0), ("P1_a_b", 1), ("P2_a_b_", 2)]


def test_a_slot_is_written_by_its_name_and_without_one_by_its_index() -> None:
    names = {"gain": ("P", 11), "limit": ("P", 2), "x": ("Y", 0)}
    value = apply("Add", apply("Mul", parameter(11), parameter(2)), parameter(7))
    row: Any = SimpleNamespace(vector="p", index=2, value=value, source=None, place=None)
    body = source(names, initial=[row]).initial()
    code = re.sub(r"/\*.*?\*/|\s", "", body)
    for text in ("p[P11_gain]*p[P2_limit]", "p[7]"):
        assert text in code
    assert code.startswith("p[P2_limit]=")


def test_a_state_and_an_algebraic_variable_have_their_vectors() -> None:
    """In derivatives a state is one of x, in everything else both rest in y."""
    names = {"s": ("Y", 0), "k": ("P", 0)}
    both = apply("Mul", variable(0), parameter(0))
    rate: Any = SimpleNamespace(vector="dx", index=0, value=both, source=None, place=None)
    made = source(names, derivatives=[rate], state_count=1)
    assert "dx[0] = (x[0]*p[P0_k])" in made.derivatives().replace(" * ", "*")
    row: Any = SimpleNamespace(vector="p", index=0, value=apply("Add", both, const(1.0)),
                               source=None, place=None)  # fmt: skip
    assert "y[0]" in source(names, initial=[row], state_count=1).initial()
