"""What an FMU shows of the variables of a model: which, in which order, with which attributes."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.reading.texts import Texts
from axisrig.fmus.writing.variables import Variable, read_variables, scalars

NAMES = ("start", "binding", "minimum", "maximum", "nominal")
SOURCE = 'package Lib\n  type Way = Real(unit = "m");\n  type Odd = Real(unit = "s");\nend Lib;\n'
Where = Mapping[str, tuple[str, int]]


def declared(
    name: str, role: str = "parameter", scalar: str = "real", dimensions: Sequence[int] = (),
    elements: Sequence[str] = (), span: Any = None, **given: Any,
) -> Any:  # fmt: skip
    """A variable of the compiler; a value is (expression or None, values or None)."""
    attributes = {"tunable": True, "fixed": None, "causality": None, "unit": None,
                  "description": None}  # fmt: skip
    for each in NAMES:
        expression, values = given.pop(each, (None, None))
        attributes |= {each: expression, f"{each}_values": values}
    names = list(elements) or [name]
    return {
        "name": name, "role": role, "scalar_names": names, "scalar_count": len(names),
        "value_type": {"scalar": scalar, "dimensions": list(dimensions)},
        "declaration": {"span": span}, "attributes": attributes | given,
    }  # fmt: skip


def literal(value: Any) -> Any:
    return {"variability": "constant", "provenance": {},
            "operation": {"kind": "literal", "value": {"Real": value}}}  # fmt: skip


def other(kind: str, variability: str = "constant", **more: Any) -> Any:
    return {"variability": variability, "provenance": {}, "operation": {"kind": kind, **more}}


EXPRESSIONS = [
    literal(2.5),  # 0
    other("array", elements=[0, 4]),
    other("call"),  # 2
    other("call", "parameter"),
    literal(4.0),  # 4
    other("array", elements=[0, 2]),
    literal("words"),  # 6
]


def read(
    *variables: Any, where: Where | None = None, computed: Any = (), source: str = SOURCE,
    **flat: Any,
) -> Any:  # fmt: skip
    """The variables that the FMU shows. where: vector and slot of each element, by default p."""
    names = [name for each in variables for name in each["scalar_names"]]
    places = {name: ("P", n) for n, name in enumerate(names)} if where is None else where
    bindings = {name: {vector: {"index": n}} for name, (vector, n) in places.items()}
    dae = {"variables": variables, "expressions": EXPRESSIONS}
    found = {"variable_type_names": {}, "enum_literal_ordinals": {}} | flat
    files = {1: (Path("/lib/Lib/package.mo"), source)}
    ir = Ir("Lib.M", {"layout": {"bindings": bindings}}, dae, found, files, Path("/lib"))
    system: Any = SimpleNamespace(
        initial=[SimpleNamespace(vector=vector, index=index) for vector, index in computed]
    )
    return read_variables(ir, system, Texts(ir))


def one(*args: Any, where: Where | None = None, **given: Any) -> Variable:
    (found,) = read(declared(*args, **given), where=where)
    assert isinstance(found, Variable)
    return found


def test_references_count_from_two_over_what_is_shown_alone() -> None:
    """1 is the time. Constants, what has no place, and the compiler's own names are left out."""
    shown = ("a", "part.b", "'odd name'", "x_1.y")
    hidden = ("$pre.a", "c d", "1x", "a..b", "_der(x)")
    variables = [declared("k", role="constant"), declared("nowhere")]
    for name, other in zip((*shown, ""), hidden, strict=True):
        variables += [declared(other), *([declared(name)] if name else [])]
    names = [name for each in variables for name in each["scalar_names"] if name != "nowhere"]
    found = read(*variables, where={name: ("P", n) for n, name in enumerate(names)})
    assert [(each.reference, each.name) for each in found] == list(enumerate(shown, 2))
    assert [each.index for each in found] == [names.index(name) for name in shown]


@pytest.mark.parametrize(
    ("scalar", "kind", "variability"),
    [("real", "Float64", "continuous"), ("integer", "Int32", "discrete"),
     ("boolean", "Boolean", "discrete"), ("enumeration", "Int32", "discrete")],
)  # fmt: skip
def test_each_type_of_the_language_has_its_type_of_fmi(
    scalar: str, kind: str, variability: str
) -> None:
    """An enumeration whose type the compiler does not name is a whole number."""
    found = one("x", "input", scalar)
    assert (found.type, found.causality, found.variability) == (kind, "input", variability)
    assert found.start == (1.0 if scalar == "enumeration" else 0.0,)


@pytest.mark.parametrize("scalar", ["string", "clock"])
def test_a_type_that_is_not_there_is_named_with_its_variable(scalar: str) -> None:
    with pytest.raises(BuildError, match=f"label has the type {scalar}, which is not supported"):
        read(declared("label", scalar=scalar))


def test_the_values_of_an_enumeration_are_its_limits() -> None:
    flat = {
        "variable_type_names": {"mode": "Mode"},
        "enum_literal_ordinals": {"Lib.Mode.off": 1, "Lib.Mode.on": 2, "Lib.Mode.'late'": 3,
                                  "Lib.Other.off": 1},
    }  # fmt: skip
    (found,) = read(declared("mode", "input", "enumeration"), **flat)
    assert (found.type, found.enumeration, found.literals) == (
        "Enumeration", "Lib.Mode", ("off", "on", "late")
    )  # fmt: skip
    assert (found.minimum, found.maximum, found.start) == (1.0, 3.0, (1.0,))


@pytest.mark.parametrize(
    ("given", "start"),
    [
        ({}, (0.0,)), ({"start": (0, [1.5])}, (1.5,)), ({"start": (0, None)}, (2.5,)),
        ({"start": (0, [1.5]), "binding": (0, [3.5])}, (3.5,)),
        ({"start": (0, [1.5]), "binding": (2, None)}, (1.5,)),  # the binding is no number
        ({"start": (0, [True])}, (1.0,)),
    ],
)  # fmt: skip
def test_a_start_value_is_that_of_the_binding_else_of_start(
    given: dict[str, Any], start: tuple[float, ...]
) -> None:
    """As the compiler evaluates it, else the number that is written."""
    found = one("x", **given)
    assert (found.start, found.causality, found.initial) == (start, "parameter", "exact")


@pytest.mark.parametrize(
    ("given", "start"),
    [({"start": (0, [1.5])}, (1.5, 1.5)), ({"start": (0, [1.5, 2.0])}, (1.5, 2.0)),
     ({"start": (1, None)}, (2.5, 4.0)), ({"start": (0, None)}, (2.5, 2.5)), ({}, (0.0, 0.0))],
)  # fmt: skip
def test_one_value_is_that_of_all_elements(given: dict[str, Any], start: tuple[float, ...]) -> None:
    found = one("v", dimensions=(2,), elements=("v[1]", "v[2]"), **given)
    assert (found.start, found.dimensions, found.elements) == (start, (2,), ("v[1]", "v[2]"))
    assert (found.count, found.slots) == (2, (("p", 0), ("p", 1)))


@pytest.mark.parametrize(
    "start", [(2, None), (5, None), (6, None), (0, [None]), (0, [1.0, None]), (0, [1.0, 2.0])]
)
def test_a_start_value_that_is_no_number_is_refused(start: Any) -> None:
    """Nor one with another count of elements."""
    with pytest.raises(BuildError, match="the start value of x is not a number"):
        read(declared("x", start=start))


def test_elements_that_are_apart_are_refused() -> None:
    vector = declared("v", dimensions=(3,), elements=("v[1]", "v[2]", "v[3]"))
    for places in ((0, 1, 3), (1, 0, 2), (2, 1, 0)):
        where = {f"v[{n}]": ("P", place) for n, place in enumerate(places, 1)}
        with pytest.raises(BuildError, match="the elements of v are not side by side"):
            read(vector, where=where)
    split = {"v[1]": ("P", 0), "v[2]": ("Y", 1), "v[3]": ("P", 2)}
    with pytest.raises(BuildError, match="the elements of v are not side by side"):
        read(vector, where=split)
    (found,) = read(vector, where={f"v[{n}]": ("Y", n + 4) for n in (1, 2, 3)})
    assert found.slots == (("y", 5), ("y", 6), ("y", 7))
    assert read(vector, where={"v[1]": ("P", 0), "v[3]": ("P", 2)}) == []  # one has no place


@pytest.mark.parametrize(
    ("low", "high", "limits"),
    [
        ([-1.0], [2.0], (-1.0, 2.0)), ([-1.0, -3.0], [2.0, 5.0], (-3.0, 5.0)),
        ([float("-inf")], [float("inf")], (None, None)), (None, [0.0], (None, 0.0)),
        ([0.0], None, (0.0, None)), ([-1.0, float("-inf")], [2.0, float("inf")], (None, None)),
        (None, None, (None, None)),
    ],
)  # fmt: skip
def test_limits_are_those_that_hold_for_all_elements(low: Any, high: Any, limits: Any) -> None:
    found = one(
        "v", dimensions=(2,), elements=("v[1]", "v[2]"),
        minimum=(None, low), maximum=(None, high),
    )  # fmt: skip
    assert (found.minimum, found.maximum) == limits


@pytest.mark.parametrize(
    ("values", "nominal"),
    [([5.0], 5.0), ([-5.0], 5.0), ([0.0], None), (None, None), ([5.0, 5.0], 5.0),
     ([5.0, 6.0], None), ([-5.0, -5.0], 5.0)],
)  # fmt: skip
def test_a_nominal_value_is_an_amount_that_all_elements_share(values: Any, nominal: Any) -> None:
    found = one("v", dimensions=(2,), elements=("v[1]", "v[2]"), nominal=(None, values))
    assert found.nominal == nominal


@pytest.mark.parametrize("name", ["minimum", "maximum"])
@pytest.mark.parametrize(
    ("role", "scalar", "is_refused"),
    [("parameter", "real", True), ("input", "real", True), ("algebraic", "real", False),
     ("input", "integer", False)],
)  # fmt: skip
def test_a_limit_that_others_see_must_not_follow_a_parameter(
    name: str, role: str, scalar: str, is_refused: bool
) -> None:
    variable = declared("x", role, scalar, **{name: (3, [-9.0 if name == "minimum" else 9.0])})
    if is_refused:
        with pytest.raises(BuildError, match=f"{name} of x must not depend on a parameter"):
            read(variable)
    else:
        assert len(read(variable)) == 1
    variable["attributes"][name] = 0  # a number
    assert len(read(variable)) == 1


@pytest.mark.parametrize("start", [-0.5, 2.5])
def test_a_start_value_outside_is_refused_with_its_limits(start: float) -> None:
    given = {"minimum": (None, [0.0]), "maximum": (None, [2.0])}
    with pytest.raises(BuildError, match=f"start value {start:g} of x is outside 0 .. 2"):
        read(declared("x", start=(0, [start]), **given))
    # What the FMU computes is not looked at
    assert one("x", "algebraic", start=(0, [start]), **given).start is None


def test_a_unit_is_that_of_a_real_and_must_be_one() -> None:
    assert (one("x", unit="mm/s").unit, one("x", unit="").unit, one("x").unit) == (
        "mm/s", None, None
    )  # fmt: skip
    assert one("n", scalar="integer", unit="furlong").unit is None
    with pytest.raises(BuildError, match="unit furlong is not known"):
        read(declared("x", unit="furlong"))


@pytest.mark.parametrize(
    ("word", "unit", "name"),
    [("Way", "m", "Lib.Way"), ("Way", "mm", ""), ("Way", None, ""), ("Odd", "m", ""),
     ("Real", "m", "")],
)  # fmt: skip
def test_a_declared_type_is_named_where_its_unit_is_that_of_the_variable(
    word: str, unit: str | None, name: str
) -> None:
    text = f"{SOURCE}// {word} x;\n"
    start = text.index(f"{word} x;")
    span = {"source": 1, "start": start, "end": start + len(word) + 2}
    (found,) = read(declared("x", unit=unit, span=span), source=text)
    assert found.declared == name


def test_a_description_is_one_line() -> None:
    assert one("x", description="a\n   long\tone ").description == "a long one"
    assert one("x").description == ""


def test_what_an_initial_equation_gives_is_calculated() -> None:
    """Also where it gives one element of several."""
    vector = declared("v", dimensions=(2,), elements=("v[1]", "v[2]"))
    for computed, causality in (((), "parameter"), ((("p", 1),), "calculatedParameter"),
                                ((("y", 1),), "parameter")):  # fmt: skip
        (found,) = read(vector, computed=computed)
        assert (found.causality, found.start is None) == (
            causality, causality != "parameter"
        )  # fmt: skip


@pytest.mark.parametrize(
    ("role", "given", "is_settable"),
    [("parameter", {}, True), ("parameter", {"tunable": False}, False), ("input", {}, True),
     ("state", {"fixed": True}, True), ("state", {"fixed": False}, False),
     ("algebraic", {}, False)],
)  # fmt: skip
def test_inputs_parameters_and_fixed_states_take_a_value(
    role: str, given: dict[str, Any], is_settable: bool
) -> None:
    assert one("x", role, **given).settable is is_settable


def test_each_element_is_a_scalar_with_its_own_start_and_place() -> None:
    first, second = read(
        declared("v", dimensions=(2,), elements=("v[1]", "v[2]"), start=(0, [1.5, 2.0])),
        declared("x", "algebraic"),
    )  # fmt: skip
    found = scalars([first, second])
    assert [(each.reference, each.name, each.start, each.index) for each in found] == [
        (2, "v[1]", (1.5,), 0), (3, "v[2]", (2.0,), 1), (4, "x", None, 2),
    ]  # fmt: skip
    assert {each.dimensions for each in found} == {()}
