"""Variables of a description: attributes, limits, start values, and what outputs depend on."""

import math
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_words_of_models import texts

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import TIME, apply, parameter, variable
from axisrig.fmus.writing.archive import _limits, _start
from axisrig.fmus.writing.description import (
    _attributes,
    _base_unit,
    _dependencies,
    _display_unit,
    _is_initial_unknown,
    _value_attributes,
)
from axisrig.fmus.writing.early import early_levels
from axisrig.fmus.writing.structure import output_dependencies
from axisrig.fmus.writing.units import read_unit
from axisrig.fmus.writing.variables import Variable, _check_start, _limit, _words, scalars


def shown(**given: Any) -> Variable:
    values: dict[str, Any] = {
        "reference": 2, "name": "x", "type": "Float64", "causality": "output",
        "variability": "continuous", "initial": "calculated", "dimensions": (), "elements": ("x",),
        "start": None, "unit": None, "minimum": None, "maximum": None, "nominal": None,
        "description": "", "vector": "y", "index": 0,
    }  # fmt: skip
    return Variable(**(values | given))


@pytest.mark.parametrize(
    ("given", "written"),
    [
        ({}, ""),
        ({"unit": "m", "minimum": -1.0, "maximum": 0.1, "nominal": 2.0, "start": (0.5,)},
         ' unit="m" min="-1.0" max="0.1" nominal="2.0" start="0.5"'),
        ({"declared": "Lib.Way", "unit": "m"}, ' declaredType="Lib.Way" unit="m"'),
        ({"start": (1.0, 2.5)}, ' start="1.0 2.5"'),
        ({"type": "Int32", "minimum": 1.0, "maximum": 3.0, "nominal": 2.0, "start": (2.0,)},
         ' min="1" max="3" start="2"'),
        ({"type": "Boolean", "minimum": 0.0, "maximum": 1.0, "start": (1.0, 0.0)},
         ' start="true false"'),
        ({"type": "Enumeration", "enumeration": "Lib.E", "literals": ("a", "b"), "minimum": 1.0,
          "maximum": 2.0, "start": (2.0,)}, ' declaredType="Lib.E" start="2"'),
        ({"minimum": 0.0}, ' min="0.0"'),
    ],
)  # fmt: skip
def test_attributes_of_a_value(given: dict[str, Any], written: str) -> None:
    assert _value_attributes(shown(**given)) == written


def test_attributes_are_escaped_and_units_have_what_is_not_the_default() -> None:
    assert _attributes({"a": '<"&'}, "\n") == '\na="&lt;&#34;&amp;"'
    assert _dependencies(None) == ""
    assert _dependencies(()) == ' dependencies=""'
    assert _dependencies((1, 4)) == ' dependencies="1 4"'
    assert _base_unit(read_unit("N")) == ' kg="1" m="1" s="-2"'
    assert _base_unit(read_unit("mm")) == ' m="1" factor="0.001"'
    assert _base_unit(read_unit("degC")) == ' K="1" offset="273.15"'
    # In FMI: shown = factor * value + offset
    assert _display_unit("mm", read_unit("m")) == ' name="mm" factor="1000.0"'
    assert _display_unit("degC", read_unit("K")) == ' name="degC" factor="1.0" offset="-273.15"'
    assert _display_unit("K", read_unit("degC")) == ' name="K" factor="1.0" offset="273.15"'


def test_initial_unknowns_are_what_is_calculated_for_others() -> None:
    for causality, initial, expected in (
        ("output", "calculated", True), ("output", "exact", False),
        ("calculatedParameter", "calculated", True), ("local", "calculated", False),
        ("input", None, False),
    ):  # fmt: skip
        assert _is_initial_unknown(shown(causality=causality, initial=initial)) is expected


# --- variables


@pytest.mark.parametrize(
    ("role", "kind", "attributes", "is_free", "words"),
    [
        ("parameter", "Float64", {"tunable": True}, True, ("parameter", "fixed", "exact")),
        ("parameter", "Int32", {"tunable": False}, True, ("local", "constant", "exact")),
        ("parameter", "Float64", {"tunable": True}, False,
         ("calculatedParameter", "fixed", "calculated")),
        # one of the language's `final`, which follows from others all the same
        ("parameter", "Float64", {"tunable": False}, False,
         ("calculatedParameter", "fixed", "calculated")),
        ("parameter", "Boolean", {}, False, ("calculatedParameter", "fixed", "calculated")),
        ("input", "Float64", {}, True, ("input", "continuous", None)),
        ("input", "Boolean", {}, True, ("input", "discrete", None)),
        ("state", "Float64", {"fixed": True}, True, ("local", "continuous", "exact")),
        ("state", "Float64", {"fixed": True}, False, ("local", "continuous", "calculated")),
        ("state", "Float64", {"fixed": False}, True, ("local", "continuous", "calculated")),
        ("state", "Float64", {"fixed": None}, True, ("local", "continuous", "calculated")),
        ("state", "Float64", {"fixed": True, "causality": "output"}, True,
         ("output", "continuous", "exact")),
        ("discrete_real", "Float64", {"causality": "output"}, True,
         ("output", "discrete", "calculated")),
        ("discrete_value", "Int32", {}, True, ("local", "discrete", "calculated")),
        ("algebraic", "Float64", {"fixed": True}, True, ("local", "continuous", "calculated")),
        # inside a component: only an input of the model itself is one of its FMU
        ("algebraic", "Float64", {"causality": "input"}, True,
         ("local", "continuous", "calculated")),
    ],
)  # fmt: skip
def test_words_of_fmi_for_a_variable(
    role: str, kind: str, attributes: dict[str, Any], is_free: bool, words: tuple[Any, ...]
) -> None:
    given = {"tunable": None, "fixed": None, "causality": None} | attributes
    assert _words({"role": role, "attributes": given}, kind, is_free) == words


def test_limits_hold_for_all_elements() -> None:
    assert (_limit((1.0, 3.0), min), _limit((1.0, 3.0), max)) == (1.0, 3.0)
    assert _limit((1.0, math.inf), max) is None
    assert _limit(None, min) is None
    assert _limit((0.0,), min) == 0.0


@pytest.mark.parametrize(
    ("start", "low", "high", "fits"),
    [((1.0,), 1.0, 2.0, True), ((2.0,), 1.0, 2.0, True), ((2.1,), None, 2.0, False),
     ((0.9,), 1.0, None, False), ((1.5, 0.9), 1.0, None, False), (None, 1.0, 2.0, True),
     ((1e300,), None, None, True)],
)  # fmt: skip
def test_a_start_value_is_within_its_limits(start: Any, low: Any, high: Any, fits: bool) -> None:
    _, ir = texts()
    source = {"declaration": {}}
    made = shown(start=start, minimum=low, maximum=high)
    if fits:
        _check_start(ir, source, made)
    else:
        with pytest.raises(BuildError, match="is outside"):
            _check_start(ir, source, made)


@pytest.mark.parametrize(
    ("low", "high", "written"),
    [(None, None, ""), (0.0, None, "0 .. "), (None, 2.5, " .. 2.5"), (-1.0, 0.0, "-1 .. 0")],
)
def test_the_range_of_a_variable_in_its_documentation(low: Any, high: Any, written: str) -> None:
    """An open end is left out; the literals of an enumeration say it themselves."""
    assert _limits(shown(minimum=low, maximum=high)) == written
    assert _limits(shown(minimum=low, maximum=high, literals=("a", "b"))) == ""


def test_start_values_in_the_documentation() -> None:
    assert _start(shown(start=None)) == ""
    assert _start(shown(start=(0.1, -2.0))) == "0.1 -2"
    assert _start(shown(type="Boolean", start=(1.0, 0.0))) == "true false"
    assert _start(shown(type="Enumeration", literals=("a", "b"), start=(2.0, 1.0))) == "b a"


def test_arrays_become_scalars_side_by_side() -> None:
    made = [shown(name="a", elements=("a[1]", "a[2]"), dimensions=(2,), start=(1.0, 2.0), index=4),
            shown(name="b", elements=("b",), index=9)]  # fmt: skip
    found = scalars(made)
    assert [(v.name, v.reference, v.index, v.start, v.dimensions) for v in found] == [
        ("a[1]", 2, 4, (1.0,), ()), ("a[2]", 3, 5, (2.0,), ()), ("b", 4, 9, None, ()),
    ]  # fmt: skip
    assert made[0].slots == (("y", 4), ("y", 5))
    for given, settable in (
        ({"initial": "exact"}, True), ({"causality": "input", "initial": None}, True),
        ({"initial": "exact", "variability": "constant"}, False), ({}, False),
    ):  # fmt: skip
        assert shown(**given).settable is settable


# --- structure


def test_what_outputs_depend_on() -> None:
    """y0 a state; y1 = y0 + p0, y2 = y1 * time, y3 = p2 (before: p3), p1 by a relation of p0
    and by what is written to its memory."""

    def row(vector: str, index: int, e: Any) -> Any:
        return SimpleNamespace(vector=vector, index=index, value=e)

    system: Any = SimpleNamespace(
        state_count=1,
        algebraics=[row("y", 1, apply("Add", variable(0), parameter(0))),
                    row("y", 2, apply("Mul", variable(1), TIME)), row("y", 3, parameter(2)),
                    row("y", 5, parameter(1)), row("y", 6, parameter(5)),
                    row("y", 7, variable(8))],
        runtime=[], updates=[row("p", 2, parameter(3))], whens=[],
        conditions=[row("p", 1, parameter(6))],
        relations=[SimpleNamespace(memory=1, function=apply("Sub", parameter(0), parameter(4)))],
        schedules=[(5, None)], previous=[(3, "p", 2)],
    )  # fmt: skip
    made = [
        shown(name="in0", causality="input", vector="p", index=0, reference=2),
        shown(name="in4", causality="input", vector="p", index=4, reference=3),
        shown(name="in6", causality="input", vector="p", index=6, reference=4),
        *(shown(name=f"y{n}", index=n, reference=10 + n) for n in range(8) if n != 4),
        shown(name="inner", causality="local", index=1, reference=30),
    ]
    assert output_dependencies(system, made) == {
        10: (), 11: (2,), 12: (1, 2), 13: (), 15: (2, 3, 4), 16: (1,), 17: None,
    }  # fmt: skip


def test_levels_at_which_a_step_may_end_early() -> None:
    made = [shown(name="a", type="Boolean", vector="p", index=3),
            shown(name="b", type="Boolean", vector="p", index=7),
            shown(name="real", vector="p", index=8),
            shown(name="own", type="Boolean", vector="p", index=9, causality="local")]  # fmt: skip

    def levels(annotation: str) -> list[int]:
        _, ir = texts(f"model Part\n annotation({annotation});\nend Part;", "Part.mo")
        return early_levels(ir, made)

    assert levels("") == []
    assert levels('__axisrig(returns_early = "b, a")') == [7, 3]
    assert levels('__axisrig(returns_early = "")') == []
    for name in ("real", "own", "c"):
        with pytest.raises(BuildError, match=f"{name} is no Boolean output; there are a, b"):
            levels(f'__axisrig(returns_early = "a, {name}")')


@pytest.mark.parametrize(
    ("file", "levels"),
    [("Part", [7]), ("package", [7]), ("Lib", [7]), ("Other", []), ("Parts", [])],
)
def test_levels_are_named_by_the_class_in_a_file_of_its_own_packages(
    file: str, levels: list[int]
) -> None:
    """A namesake in another package of the library is another class."""
    made = [shown(name="b", type="Boolean", vector="p", index=7)]
    text = 'model Part\n annotation(__axisrig(returns_early = "b"));\nend Part;'
    _, ir = texts(text, f"{file}.mo")
    ir.model = "Lib.Part"
    assert early_levels(ir, made) == levels


@pytest.mark.parametrize(
    ("given", "is_level"),
    [
        ({}, True), ({"elements": ("b[1]", "b[2]")}, False), ({"type": "Int32"}, False),
        ({"vector": "y"}, False), ({"causality": "local"}, False), ({"causality": "input"}, False),
    ],
)  # fmt: skip
def test_an_early_return_is_of_one_boolean_output(given: Any, is_level: bool) -> None:
    """An array, a number, a state, an input or a local variable has no instant to report."""
    _, ir = texts('model M\n annotation(__axisrig(returns_early = " b ,, "));\nend M;', "M.mo")
    ir.model = "M"
    one: Any = {"name": "b", "type": "Boolean", "vector": "p", "index": 7, "elements": ("b",)}
    variables = [shown(**(one | given)), shown(name="a", type="Boolean", vector="p", index=3)]
    if is_level:
        assert early_levels(ir, variables) == [7]
    else:
        with pytest.raises(BuildError, match=r"^M: returns_early: b is no .*; there are a$"):
            early_levels(ir, variables)
