"""How variables and rows are written in C: by their slots, with the names of the model."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.expressions import parameter, variable
from axisrig.fmus.writing.source import _c_string, _Names, _printed, _row, _scoped
from axisrig.fmus.writing.variables import Variable

STATES = 2
BINDINGS = {
    "a.x": {"Y": {"index": 0}}, "a_v": {"Y": {"index": 1}}, "f[2]": {"Y": {"index": 2}},
    "g": {"Y": {"index": 3}}, "b.k": {"P": {"index": 7}}, "b_k": {"P": {"index": 3}},
}  # fmt: skip


def names() -> _Names:
    ir: Any = SimpleNamespace(solve={"layout": {"bindings": BINDINGS}})
    return _Names(ir, STATES)


@pytest.mark.parametrize(
    ("index", "in_derivatives"),
    [(0, "x[0]"), (1, "x[1]"), (2, "y2_f_2_"), (3, "y3_g"), (4, "y4")],
)
def test_states_are_arguments_of_a_derivative_and_the_others_are_computed_in_it(
    index: int, in_derivatives: str
) -> None:
    assert names().in_derivatives(variable(index)) == in_derivatives
    assert names().in_vectors(variable(index)) == f"y[{index}]"


@pytest.mark.parametrize(("index", "text"), [(7, "p[P7_b_k]"), (3, "p[P3_b_k]"), (5, "p[5]")])
def test_a_parameter_has_the_name_of_its_slot(index: int, text: str) -> None:
    assert names().in_derivatives(parameter(index)) == text
    assert names().in_vectors(parameter(index)) == text


def test_the_names_of_slots_come_in_their_order() -> None:
    assert names().slots == [("P3_b_k", 3), ("P7_b_k", 7)]


def test_lines_that_declare_have_a_scope_of_their_own() -> None:
    assert _scoped(["a = 1;"]) == ["a = 1;"]
    for declared in ("const double t0 = 1;", "double s0[] = {1};"):
        assert _scoped([declared, "a = t0;"]) == ["{", f"    {declared}", "    a = t0;", "}"]


def test_a_text_in_c_is_what_it_was() -> None:
    assert _c_string('a "b"\\n\nc') == '"a \\"b\\"\\\\n\\nc"'
    assert _printed("Boolean", "p[1]") == 'p[1] != 0.0 ? "true" : "false"'
    assert _printed("Real", "p[1]") == _printed("Integer", "p[1]") == "p[1]"


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, {"class": "CLASS_OUTPUT", "type": "TYPE_FLOAT64", "min": "-INFINITY", "max": "5.0"}),
        ({"causality": "input", "vector": "p"}, {"class": "CLASS_INPUT", "vector": "IN_P"}),
        ({"causality": "parameter", "initial": "exact"}, {"class": "CLASS_PARAMETER"}),
        (
            {"causality": "local", "initial": "exact", "variability": "constant"},
            {"class": "CLASS_OUTPUT"},
        ),
        ({"type": "Boolean", "minimum": 0.0}, {"type": "TYPE_BOOLEAN", "min": "0.0"}),
        ({"maximum": None, "elements": ("a", "b")}, {"max": "INFINITY", "count": "2"}),
    ],
)
def test_a_row_of_the_table_of_variables(changes: dict[str, Any], expected: dict[str, str]) -> None:
    base: dict[str, Any] = {
        "reference": 2, "name": "v", "type": "Float64", "causality": "output",
        "variability": "continuous", "initial": "calculated", "dimensions": (), "elements": ("v",),
        "start": None, "unit": None, "minimum": None, "maximum": 5.0, "nominal": None,
        "description": "", "vector": "y", "index": 4,
    }  # fmt: skip
    found = _row(Variable(**base | changes), "fmi3.inc")
    assert found | expected == found
    assert (found["name"], found["index"]) == ("v", "4")


@pytest.mark.parametrize(
    ("slave", "kind"), [("fmi3.inc", "TYPE_ENUMERATION"), ("fmi2.inc", "TYPE_INT32")]
)
def test_an_enumeration_of_version_2_is_read_as_an_integer(slave: str, kind: str) -> None:
    one = Variable(
        2, "v", "Enumeration", "output", "discrete", "calculated", (), ("v",), None, None, 1.0, 3.0,
        None, "", "p", 4, "Kind", ("a", "b", "c"),
    )  # fmt: skip
    assert _row(one, slave)["type"] == kind
