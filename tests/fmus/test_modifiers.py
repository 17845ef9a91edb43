"""A modifier that names nothing stops the build: the compiler would keep the default."""

from pathlib import Path

import pytest

from axisrig.fmus.build import LIBRARY
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import compile_model
from axisrig.fmus.reading.modified import refuse_unknown_modifiers
from axisrig.fmus.reading.texts import Texts


def look_at(folder: Path, text: str, name: str = "M") -> None:
    file = folder / f"{name}.mo"
    file.write_text(text, encoding="utf-8")
    ir = compile_model(name, file, (LIBRARY,))
    refuse_unknown_modifiers(ir, Texts(ir))


AXIS = "AxisRig.Drives.ServoAxis"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"extends {AXIS}(kvv = 30);", r"no kvv to modify in .*ServoAxis; did you mean kv"),
        (f"extends {AXIS}(kv(startt = 30));", r"no startt to modify; did you mean start"),
        (f"extends {AXIS}(stop(stiffnes = 1e7));", "no stiffnes to modify; did you mean stiffness"),
        (f"extends {AXIS}(mass = 5, final vveight = 3);", "no vveight to modify"),
        # these the compiler sees itself
        (f"{AXIS} a(kvv = 30);", "unknown modifier `kvv` for component `a`"),
        ("Real x(strat = 1); equation x = 1;", "unknown modifier `strat`"),
    ],
)  # fmt: skip
@pytest.mark.long
def test_a_name_that_nothing_has_is_an_error(tmp_path: Path, line: str, words: str) -> None:
    text = f"model M\n  // kv\n  {line}\nend M;\n"
    with pytest.raises(BuildError, match=words) as caught:
        look_at(tmp_path, text)
    assert (caught.value.file, caught.value.line) == ("M.mo", 3)


def test_a_class_in_the_same_file_and_a_short_class_are_looked_at_too(tmp_path: Path) -> None:
    text = """model M
  model Inner
    parameter Real gain = 1;
    Real x;
  equation
    x = gain;
  end Inner;
  model Other = Inner(gian = 2);
  Other o;
end M;
"""
    with pytest.raises(BuildError, match="no gian to modify in Inner; did you mean gain") as caught:
        look_at(tmp_path, text)
    assert caught.value.line == 8


@pytest.mark.long
def test_names_that_are_there_pass(tmp_path: Path) -> None:
    """Attributes, parts of parts, base classes of base classes, conditions, several in a line."""
    look_at(
        tmp_path,
        f"""model M
  parameter Boolean has = false;
  parameter Integer n = 2;
  extends {AXIS}(kv = 30, mass(min = 1, start = 200), stop(stiffness = 1e7));
  model Part
    parameter Real gain[2](each min = 0) = {{1, 2}}, offset(unit = "m", displayUnit = "mm") = 0;
    Real y(start = 0, fixed = true);
  equation
    der(y) = gain[1] + offset;
  end Part;
  Part p(gain = {{3, 4}}), q(offset(nominal = 1) = 2, y(start = 3));
  Part left(gain = {{3, 4}}) if has;
  Part many[n](each offset = 1);
end M;
""",
    )


@pytest.mark.parametrize("model", ["Drives.ScrewAxis", "Drives.GantryPair", "Machines.ProbeOnAxis"])
@pytest.mark.long
def test_the_library_passes(model: str) -> None:
    ir = compile_model(f"AxisRig.{model}", LIBRARY)
    refuse_unknown_modifiers(ir, Texts(ir))


def test_a_class_that_the_library_does_not_have_is_answered_with_the_nearest(
    tmp_path: Path,
) -> None:
    with pytest.raises(BuildError, match=r"does not exist; did you mean AxisRig\.Drives\.ServoAxi"):
        look_at(tmp_path, "model M\n  extends AxisRig.Drives.ServoAxes(kv = 30);\nend M;\n")


def test_a_file_with_another_class_says_which(tmp_path: Path) -> None:
    text = "model N\n  extends AxisRig.Drives.ServoAxis(kv = 30);\nend N;\n"
    with pytest.raises(BuildError, match=r"holds the class N; rename the class to M, or .* N\.mo"):
        look_at(tmp_path, text)
