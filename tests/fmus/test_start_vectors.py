"""Where the start values of a model go: to the slots of their variables, and of what was before."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.writing.variables import start_vectors

SLOTS = {
    "x": {"Y": {"index": 0}}, "v[1]": {"Y": {"index": 1}}, "v[2]": {"Y": {"index": 2}},
    "k": {"P": {"index": 0}}, "n": {"P": {"index": 2}}, "e": {"P": {"index": 1}},
}  # fmt: skip


def declared(name: str, start: Any = None, binding: Any = None, scalar: str = "real") -> Any:
    elements = [each for each in SLOTS if each.partition("[")[0] == name]
    return {
        "name": name, "scalar_names": elements, "scalar_count": len(elements),
        "value_type": {"scalar": scalar}, "declaration": {},
        "attributes": {
            "start": None if start is None else 0, "start_values": start,
            "binding": None if binding is None else 0, "binding_values": binding,
        },
    }  # fmt: skip


def vectors(*variables: Any, variability: str = "constant", initial: Any = ()) -> Any:
    expression = {"variability": variability, "provenance": {}}
    ir = Ir(
        "M", {"layout": {"bindings": SLOTS}}, {"variables": variables, "expressions": [expression]},
        {}, {}, SimpleNamespace(),  # type: ignore[arg-type]
    )  # fmt: skip
    system: Any = SimpleNamespace(
        y_count=3, p_count=6, initial=initial,
        previous=[(3, "y", 1), (4, "p", 2), (5, "y", 0)],
    )  # fmt: skip
    return start_vectors(ir, system)


def test_each_start_value_is_at_the_place_of_its_variable() -> None:
    """A binding counts before a start; without both it is 0, and the first literal has number 1.

    What was before an event begins as what it is of: slots 3, 4, 5 of y1, p2, y0.
    """
    found = vectors(
        declared("x", start=[1.5]), declared("v", start=[2.0, 3.0]),
        declared("k", start=[9.0], binding=[4.0]), declared("n", start=[7], scalar="integer"),
        declared("e", scalar="enumeration"),
    )  # fmt: skip
    assert found == ([1.5, 2.0, 3.0], [4.0, 1.0, 7.0, 2.0, 7.0, 1.5])
    assert vectors(declared("v", start=[2.5])) == ([0.0, 2.5, 2.5], [0.0, 0.0, 0.0, 2.5, 0.0, 0.0])


def test_a_start_that_follows_a_parameter_needs_an_initial_equation() -> None:
    one = declared("x", start=[1.0])
    with pytest.raises(BuildError, match="start of x must not depend on a parameter"):
        vectors(one, variability="parameter")
    equation = SimpleNamespace(vector="y", index=0)
    assert vectors(one, variability="parameter", initial=[equation])[0] == [1.0, 0.0, 0.0]
    two = declared("v", start=[1.0, 2.0])
    with pytest.raises(BuildError, match="start of v must not depend on a parameter"):
        vectors(two, variability="parameter", initial=[SimpleNamespace(vector="y", index=1)])
