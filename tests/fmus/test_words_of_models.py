"""What is read in the text of a library, and how a description writes it; nothing is compiled."""

import ast
import math
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations.clocks import _expression
from axisrig.fmus.reading.classes import class_names, used_classes
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import TIME, apply, const, parameter, variable
from axisrig.fmus.reading.texts import Texts, inside
from axisrig.fmus.writing.archive import _limits, _start
from axisrig.fmus.writing.description import (
    _attributes,
    _base_unit,
    _dependencies,
    _display_unit,
    _experiment,
    _is_initial_unknown,
    _value_attributes,
    head_of,
    identifier_of,
)
from axisrig.fmus.writing.early import early_levels
from axisrig.fmus.writing.structure import output_dependencies
from axisrig.fmus.writing.units import read_unit
from axisrig.fmus.writing.variables import Variable, _check_start, _limit, _words, scalars

LIBRARY = """
within;
package Lib "a library" /* model Fake end Fake; */
  type Way = Real(quantity = "Length", unit = "m", displayUnit = "mm", nominal = 2e-3);
  type Far = Way(nominal = -5);
  type Same = Same;
  connector WayInput = input Way;
  partial model Base "of
    all"
    Way x;
    annotation(Documentation(info = "<html><p>Says \\"x\\" (y).</p></html>"));
  end Base;
  package Inner
    model Part "inner part"
      extends Lib.Base;
      Second second(k = 3);
      Second third;
      annotation(experiment(StartTime = 0.5, StopTime = 2, Tolerance = 1e-6, Interval = 0.01));
    end Part;
    model Second
      parameter Real k = 1; // model Third end Third;
    end Second;
  end Inner;
  annotation(version = "1.2.3");
end Lib;
"""


def texts(text: str = LIBRARY, name: str = "package.mo") -> tuple[Texts, Any]:
    ir: Any = SimpleNamespace(
        files={1: (Path(name), text)},
        model="Lib.Inner.Part",
        flat={"model_description": "a \n  part"},
        error=lambda _span, message: BuildError("Lib", None, message),
    )
    return Texts(ir), ir


def test_classes_have_their_full_names_and_no_comment_is_one() -> None:
    found, _ = texts()
    names = ["Lib", "Lib.Way", "Lib.Far", "Lib.WayInput", "Lib.Base", "Lib.Inner", "Lib.Inner.Part",
             "Lib.Inner.Second"]  # fmt: skip
    assert all(found.get(name) is not None for name in names)
    assert found.get("Lib.Inner.Third") is None
    assert found.get("Lib.Fake") is None
    assert found.get("Lib.Base").title == "of all"  # type: ignore[union-attr]
    assert found.get("Lib.Base").documentation() == '<p>Says "x" (y).</p>'  # type: ignore[union-attr]
    assert found.get("Lib.Inner").documentation() == ""  # type: ignore[union-attr]
    within, _ = texts("within A.B;\nmodel C\nend C;\nblock D\nend D;", "C.mo")
    assert (within.get("A.B.C") is not None, within.get("A.B.D") is not None) == (True, True)


def test_a_name_means_that_of_the_innermost_package() -> None:
    found, _ = texts("package A model M end M;\n package B\n model M end M;\n end B;\n end A;")
    for scope, name in (
        ("A.B", "A.B.M"), ("A.B.X", "A.B.M"), ("A", "A.M"), ("A.C", "A.M"), ("", None),
    ):  # fmt: skip
        resolved = found.resolve("M", scope)
        assert (resolved.name if resolved else None) == name


def test_a_type_has_what_it_is_made_from() -> None:
    found, _ = texts()
    way = {"quantity": "Length", "unit": "m", "displayUnit": "mm", "nominal": "2e-3"}
    for name, expected in (("Lib.Way", way), ("Lib.Far", way | {"nominal": "-5"})):
        kind = found.get(name)
        assert kind is not None
        assert found.attributes(kind) == expected
    same = found.get("Lib.Same")
    assert same is not None
    assert found.attributes(same) == {}


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("Way", "Way"), ("WayInput", "Way"), ("Second", "Way"), ("Third", "Way"),
        ("FarInput", "Far"), ("Real", None), ("Bus", None), ("Absent", None),
    ],
)  # fmt: skip
def test_the_type_of_a_variable_is_looked_for_through_its_connectors(
    written: str, name: str | None
) -> None:
    text = """package Lib
  type Way = Real(unit = "m");
  type Far = Way(nominal = 5);
  connector WayInput = input Way;
  connector Second = WayInput;
  connector Third = output Second;
  connector FarInput = input Far;
  connector Bus Real x; end Bus;
  // \u00e4: two bytes
  model Part
    """
    found, ir = texts(f"{text}{written} x;\n  end Part;\nend Lib;")
    start = len(text.encode())
    for source, expected in ((1, name and f"Lib.{name}"), (2, None)):
        span = {"source": source, "start": start, "end": start + len(f"{written} x")}
        kind = found.declared_type(ir, {"declaration": {"span": span}})
        assert (kind.name if kind else None) == expected
    assert found.declared_type(ir, {"declaration": {}}) is None


def test_what_a_model_is_made_of() -> None:
    found, _ = texts()
    assert [each.name for each in found.bases("Lib.Inner.Part")] == ["Lib.Inner.Part", "Lib.Base"]
    used = [each.name for each in found.used("Lib.Inner.Part")]
    assert used == ["Lib.Inner.Part", "Lib.Base", "Lib.Inner.Second"]
    assert class_names("model A end A; block B\n end B;") == ["A", "B"]
    bodies = list(used_classes({1: "model A B b; end A; model B end B; model C end C;"}, "Lib.A"))
    assert [body.text.split()[0] for body in bodies] == ["A", "B"]
    assert (inside("f(a(b)c)d", 2), inside("(a", 1)) == ("a(b)c", "")


def test_a_class_is_without_the_inner_ones_which_come_on_their_own() -> None:
    """Each from its name on, at its place in the file; comments and inner classes are blank."""
    text = """// model Not end Not;
package A "model No end No;"
  block B
    record C Real x; end C;
    C c;
  end B;
  model D
    B b;
  end D;
end A;
"""
    found = {body.text.split()[0]: body for body in used_classes({4: text}, "Lib.A.D")}
    assert list(found) == ["D", "B", "C"]
    for name, body in found.items():
        assert text[body.offset :].startswith(name)
        assert body.number == 4
        assert len(body.text) == text.index(f"end {name};") - body.offset
        assert body.text.split()[0] == name
    assert "Real" not in found["B"].text
    assert found["B"].text.split()[-2:] == ["C", "c;"]
    assert found["C"].text.split() == ["C", "Real", "x;"]
    assert class_names("model A = B; model C end D; end C; function f") == ["C", "f"]


@pytest.mark.parametrize(
    ("file", "line", "text"),
    [("M.mo", 3, "M.mo:3: wrong"), ("M.mo", None, "M.mo: wrong"), (None, None, "wrong")],
)
def test_an_error_of_a_build_names_its_place(file: str | None, line: int | None, text: str) -> None:
    error = BuildError(file, line, "wrong")
    assert (str(error), error.message) == (text, "wrong")


@pytest.mark.parametrize(
    ("written", "result"),
    [("0.5", const(0.5)), ("3", const(3)), ("a.b", parameter(7)),
     ("-a.b", apply("Neg", parameter(7))),
     ("2*a.b - 1", apply("Sub", apply("Mul", const(2), parameter(7)), const(1))),
     ("a.b/4 + k", apply("Add", apply("Div", parameter(7), const(4)), parameter(9))),
     ("-0.5", const(-0.5)), ("f(1)", None), ("a.b^2", None), ("a.b % 2", None), ("not k", None),
     ("'text'", None)],
)  # fmt: skip
def test_start_and_interval_of_a_sample(written: str, result: Any) -> None:
    tree = ast.parse(written.replace("^", "**"), mode="eval").body
    slots = {"a.b": [7], "k": [9]}
    if result is None:
        with pytest.raises(ValueError, match=re.escape(ast.unparse(tree))):
            _expression(tree, slots)
    else:
        assert _expression(tree, slots) is result


@pytest.mark.parametrize(
    ("annotation", "expected"),
    [
        ("", (0.0, 1.0, 1e-9, 1e-3)),
        ("experiment(StopTime = 5)", (0.0, 5.0, 1e-9, 1e-3)),
        ("experiment(StartTime = 3)", (3.0, 4.0, 1e-9, 1e-3)),
        ("experiment(StartTime = 3, StopTime = 3)", (3.0, 4.0, 1e-9, 1e-3)),
        ("experiment(StartTime=-1, StopTime=+2.5e1, Tolerance=1e-6, Interval=0.01)",
         (-1.0, 25.0, 1e-6, 0.01)),
    ],
)  # fmt: skip
def test_the_experiment_of_a_model(annotation: str, expected: tuple[float, ...]) -> None:
    found, _ = texts(f"model M\n annotation({annotation});\nend M;")
    names = ("startTime", "stopTime", "tolerance", "stepSize")
    assert _experiment(found.get("M")) == dict(zip(names, map(repr, expected), strict=True))
    assert _experiment(None)["stopTime"] == "1.0"


def test_the_head_of_a_description() -> None:
    found, ir = texts()
    assert head_of(ir, found) == {"description": "a part", "version": "1.2.3"}
    own, ir = texts("package AxisRig\nend AxisRig;")
    ir.model, ir.flat = "AxisRig.Drives.Servo", {"model_description": None}
    head = head_of(ir, own)
    assert (head["description"], head["author"], head["license"]) == ("", "axisrig", "Apache-2.0")
    assert head["version"]
    assert head["copyright"] == "Copyright the authors of axisrig"
    own, ir = texts('package AxisRig\n  annotation(version = "4.5");\nend AxisRig;')
    ir.model, ir.flat = "AxisRig.Drives.Servo", {"model_description": " a\n  servo "}
    head = head_of(ir, own)
    assert (head["description"], head["version"]) == ("a servo", "4.5")
    ir.model = "AxisRigs.Servo"  # of another library
    assert head_of(ir, own) == {"description": "a servo"}
    assert identifier_of("Lib.Inner.'a b'") == "Lib_Inner__a_b_"


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
    ("keyword", "is_part"), [("model", True), ("block", True), ("record", False)]
)
def test_parts_of_a_model_are_models_and_blocks(keyword: str, is_part: bool) -> None:
    text = f"""
{keyword} Part
  Real y;
end Part;
model Whole
  Part first;
  Part second;
end Whole;
"""
    found, _ = texts(text, "Whole.mo")
    assert [one.name for one in found.used("Whole")] == ["Whole", "Part"][: 1 + is_part]


@pytest.mark.parametrize(
    "info", ["<html>\\n  says <b>x</b>\\n</html>", "says <b>x</b>", "<html>says <b>x</b></html> "]
)
def test_the_documentation_has_no_frame_and_no_blanks_around_it(info: str) -> None:
    text = f'model M annotation(Documentation(info = "{info}")); end M;'.replace("\\n", "\n")
    found, _ = texts(text, "M.mo")
    model = found.get("M")
    assert model is not None
    assert model.documentation() == "says <b>x</b>"
