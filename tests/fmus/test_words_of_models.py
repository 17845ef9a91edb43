"""What is read in the text of a library, and how a description writes it; nothing is compiled."""

import ast
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.equations.clocks import _expression
from axisrig.fmus.reading.classes import class_names, used_classes
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import apply, const, parameter
from axisrig.fmus.reading.texts import Texts, inside
from axisrig.fmus.writing.description import (
    _experiment,
    head_of,
    identifier_of,
)

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
