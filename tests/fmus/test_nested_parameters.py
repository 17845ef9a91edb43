"""Parameters of components: which ones a user of the FMU can set, and under what name."""

from pathlib import Path

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from tests.small_fmus import small_fmu

from axisrig.fmus import BuildError
from axisrig.fmus.build import build

LIBRARY = """package Small
  model Spring
    parameter Real stiffness(unit="N/m", min=0) = 20 "Stiffness";
    parameter Real length(unit="m", start=0.5) "Free length";
    parameter Real energy(unit="N.m") = stiffness*length^2/2 "Energy at half the length";
    parameter Integer turns = 3 + 4 "Turns";
    final parameter Real share(unit="1") = 0.25 "Never another";
    output Real force(unit="N") "Force";
  equation
    force = stiffness*length*share;
  end Spring;
  model Box
    Spring spring(stiffness=30);
  end Box;
  model Frame
    parameter Real stiffness(unit="N/m") = 50 "Of the spring in it";
    Spring spring(stiffness=stiffness);
  end Frame;
  model Plant
    parameter Real length(unit="m") = 0.1 "Of the left spring";
    output Real force(unit="N") "Sum";
    Spring left(length=length);
    Box box;
    Frame frame(stiffness=60);
  equation
    force = left.force + box.spring.force;
  end Plant;
end Small;
"""


@pytest.fixture(scope="module")
def plant(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("nested")
    root = folder / "Small"
    root.mkdir()
    (root / "package.mo").write_text(LIBRARY, encoding="utf-8")
    return small_fmu("Small.Plant", root)


@pytest.mark.parametrize(
    ("name", "causality", "variability", "start"),
    [
        ("length", "parameter", "fixed", "0.1"),
        ("left.stiffness", "parameter", "fixed", "20.0"),
        ("left.length", "calculatedParameter", "fixed", None),
        ("left.energy", "calculatedParameter", "fixed", None),
        ("left.turns", "parameter", "fixed", "7"),
        ("left.share", "local", "constant", "0.25"),
        ("box.spring.stiffness", "parameter", "fixed", "30.0"),
        ("box.spring.length", "parameter", "fixed", "0.5"),
        ("frame.stiffness", "parameter", "fixed", "60.0"),
        ("frame.spring.stiffness", "calculatedParameter", "fixed", None),
    ],
)
def test_plain_numbers_can_be_set_and_bound_ones_are_calculated(
    plant, name, causality, variability, start
):
    description = fmpy.read_model_description(str(plant))
    (found,) = (v for v in description.modelVariables if v.name == name)
    assert (found.causality, found.variability, found.start) == (causality, variability, start)


def test_validator_finds_no_problem(plant):
    assert validate_fmu(str(plant)) == []


def test_set_values_reach_the_equations_and_what_is_bound_follows(load, plant):
    fmu = load(plant, **{"length": 0.2, "left.stiffness": 40.0, "box.spring.length": 2.0})
    assert fmu.get("left.length") == 0.2
    assert fmu.get("left.energy") == pytest.approx(40.0 * 0.2**2 / 2, rel=1e-15)
    assert fmu.force == pytest.approx((40.0 * 0.2 + 30.0 * 2.0) * 0.25, rel=1e-15)


def test_a_parameter_of_the_same_name_follows_although_the_compiler_writes_the_number(load, plant):
    fmu = load(plant, **{"frame.stiffness": 70.0})
    assert fmu.get("frame.spring.stiffness") == 70.0
    assert fmu.get("frame.spring.force") == pytest.approx(70.0 * 0.5 * 0.25, rel=1e-15)


@pytest.mark.parametrize("name", ["left.length", "left.share"])
def test_what_is_calculated_or_final_cannot_be_set(load, plant, name):
    fmu = load(plant)
    fmu.slave.reset()
    fmu.slave.enterInitializationMode()
    with pytest.raises(FMICallException):
        fmu.set(**{name: 1.0})
    assert f"{name} cannot be set" in fmu.messages[-1]


def test_limits_of_a_component_hold(load, plant):
    with pytest.raises(FMICallException):
        load(plant, **{"box.spring.stiffness": -1.0})


def test_start_value_outside_its_limits_is_refused_with_its_line(tmp_path):
    root = tmp_path / "Small"
    root.mkdir()
    text = LIBRARY.replace("Spring spring(stiffness=30);", "Spring spring(stiffness=-30);")
    (root / "package.mo").write_text(text, encoding="utf-8")
    with pytest.raises(
        BuildError, match=r"-30 of box\.spring\.stiffness is outside 0 \.\. inf"
    ) as e:
        build("Small.Plant", tmp_path / "plant.fmu", root)
    assert (e.value.file, e.value.line) == ("Small/package.mo", 3)
