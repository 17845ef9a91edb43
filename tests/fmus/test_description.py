"""modelDescription.xml of both versions, read back and compared with the Modelica source."""

import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from tests.small_fmus import small_fmu

from axisrig.fmus import FMI_VERSIONS

LIBRARY = """package Small "Library"
  type Mode = enumeration(off "Nothing", on "All", idle);
  model Plant "All that is shown & <how>"
    parameter Mode mode = Mode.on "Which";
    parameter Real k[3](each unit="N/mm", each min=0) = {1, 2, 3} "Gains";
    parameter Real m[2,2](each unit="1", min={{0, -7}, {1, -2}}, max={{9, 8}, {50, 10}},
      nominal={{1, 2}, {1, 1}}) = {{1, 2}, {3, 4}} "Matrix";
    parameter Boolean flags[2] = {true, false} "Switches";
    parameter Integer size(min=1, max=9) = 3 "Number";
    input Real u[2](each unit="m", each start=0.5) "Ways";
    input Real v(unit="degC", start=20, min=-50, max=200) "Warmth";
    input Boolean go(start=true) "Switch";
    output Real y[2](each unit="m") "Result";
    output Real z(unit="K") "Absolute";
    output Real w(unit="deg", nominal=90) "Angle";
    output Integer n(start=0) "Count";
    output Mode state "Now";
    Real x(start=1, fixed=true, unit="m");
  equation
    der(x) = -k[1]*x + u[1]*m[2,1] + (if go then 0 else 1);
    y[1] = 2*x + k[2]*m[1,2];
    y[2] = u[2] + k[3]*size;
    z = v + 273.15;
    w = x*time;
    when u[1] > 1 then n = pre(n) + 1; end when;
    state = if flags[1] then mode else Mode.off;
    annotation(experiment(StartTime=0.5, StopTime=2.0, Interval=0.01, Tolerance=1e-6));
  end Plant;
end Small;
"""
STATE_AT_2 = 1.5 - 0.5 * np.exp(-1.5)  # x' = 1.5 - x from x = 1 over 1.5 s


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """An FMU of the model above for each version."""
    folder = tmp_path_factory.mktemp("description")
    (folder / "Small").mkdir()
    (folder / "Small" / "package.mo").write_text(LIBRARY, encoding="utf-8")
    library = folder / "Small"
    return {v: small_fmu("Small.Plant", library, fmi=v) for v in FMI_VERSIONS}


def described(fmu: Path) -> dict[str, fmpy.model_description.ModelVariable]:
    return {v.name: v for v in fmpy.read_model_description(str(fmu)).modelVariables}


def root(fmu: Path) -> ET.Element:
    return ET.fromstring(zipfile.ZipFile(fmu).read("modelDescription.xml"))


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_validator_finds_no_problem(fmus, fmi):
    assert validate_fmu(str(fmus[fmi])) == []


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_model_and_experiment_are_those_of_the_source(fmus, fmi):
    found = fmpy.read_model_description(str(fmus[fmi]))
    assert found.modelName == "Small.Plant"
    assert found.description == "All that is shown & <how>"
    experiment = found.defaultExperiment
    assert [
        float(getattr(experiment, name))
        for name in ("startTime", "stopTime", "stepSize", "tolerance")
    ] == [0.5, 2.0, 0.01, 1e-6]


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
@pytest.mark.parametrize(
    ("name", "causality", "variability", "initial", "start"),
    [
        ("mode", "parameter", "fixed", "exact", "2"),
        ("size", "parameter", "fixed", "exact", "3"),
        ("v", "input", "continuous", "exact", "20.0"),
        ("go", "input", "discrete", "exact", "true"),
        ("z", "output", "continuous", "calculated", None),
        ("n", "output", "discrete", "calculated", None),
        ("state", "output", "discrete", "calculated", None),
        ("x", "local", "continuous", "exact", "1.0"),
        ("time", "independent", "continuous", None, None),
    ],
)
def test_words_of_a_variable(fmus, fmi, name, causality, variability, initial, start):
    v = described(fmus[fmi])[name]
    assert (v.causality, v.variability, v.initial) == (causality, variability, initial)
    assert v.start == start


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_initial_is_not_written_for_inputs(fmus, fmi):
    """Both versions forbid the attribute there, though its only meaning is `exact`."""
    tags = [e for e in root(fmus[fmi]).iter() if e.get("causality") in ("input", "independent")]
    assert tags
    assert all("initial" not in e.attrib for e in tags)


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_limits_units_and_nominal_values(fmus, fmi):
    found = described(fmus[fmi])
    assert [float(found["v"].min), float(found["v"].max), found["v"].unit] == [-50, 200, "degC"]
    assert [int(found["size"].min), int(found["size"].max)] == [1, 9]
    assert float(found["w"].nominal) == 90
    units = {
        u.name: u.baseUnit for u in fmpy.read_model_description(str(fmus[fmi])).unitDefinitions
    }
    assert (units["degC"].K, units["degC"].offset, units["degC"].factor) == (1, 273.15, 1.0)
    assert (units["N/mm"].kg, units["N/mm"].s, units["N/mm"].factor) == (1, -2, 1000.0)
    assert (units["deg"].rad, units["deg"].factor) == (1, pytest.approx(np.pi / 180, rel=1e-15))


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_limits_of_an_array_let_each_element_have_its_own(fmus, fmi):
    """The description has one of each for all: the smallest and the largest; of several nominal
    values none.
    """
    found = [v for name, v in described(fmus[fmi]).items() if name.partition("[")[0] == "m"]
    assert len(found) == (1 if fmi == "3.0" else 4)
    assert {(float(v.min), float(v.max), v.nominal) for v in found} == {(-7.0, 50.0, None)}


def test_array_is_one_variable_with_dimensions_in_version_3(fmus):
    found = described(fmus["3.0"])
    assert [d.start for d in found["m"].dimensions] == [2, 2]
    assert found["m"].start == "1.0 2.0 3.0 4.0"
    assert found["flags"].start == "true false"
    assert [d.start for d in found["y"].dimensions] == [2]


def test_array_is_one_scalar_for_each_element_in_version_2(fmus):
    found = described(fmus["2.0"])
    assert [found[f"m[{i},{j}]"].start for i in (1, 2) for j in (1, 2)] == [
        *("1.0", "2.0", "3.0", "4.0")
    ]
    assert [found[f"flags[{i}]"].start for i in (1, 2)] == ["true", "false"]
    assert found["k[3]"].min == "0.0"
    assert "k" not in found


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_enumeration_has_its_type_with_the_names_of_its_values(fmus, fmi):
    found = fmpy.read_model_description(str(fmus[fmi]))
    (mode,) = found.typeDefinitions
    assert mode.name == "Small.Mode"
    assert [(i.name, int(i.value)) for i in mode.items] == [("off", 1), ("on", 2), ("idle", 3)]
    names = {v.name for v in found.modelVariables if v.declaredType is mode}
    assert names == {"mode", "state"}


@pytest.mark.parametrize(
    ("fmi", "expected"),
    [
        (
            "3.0",
            {"y": {"u"}, "z": {"v"}, "w": {"time"}, "n": {"u"}, "state": set()},
        ),
        (
            "2.0",
            {
                "y[1]": set(),
                "y[2]": {"u[2]"},
                "z": {"v"},
                "w": {"time"},
                "n": {"u[1]"},
                "state": set(),
            },
        ),
    ],
)
def test_outputs_name_what_they_depend_on_at_the_same_instant(fmus, fmi, expected):
    """States are memory: y[1] follows x alone, w follows x and the time."""
    outputs = fmpy.read_model_description(str(fmus[fmi])).outputs
    assert {o.variable.name: {d.name for d in o.dependencies} for o in outputs} == expected


@pytest.mark.parametrize("fmi", FMI_VERSIONS)
def test_values_of_every_type_go_in_and_come_out(fmus, fmi):
    scalar = fmi == "2.0"
    start = {"mode": 3, "size": 5, "v": 30.0}
    start |= {"m[1,2]": 7.0} if scalar else {"m": [1.0, 7.0, 3.0, 4.0]}
    start |= {"flags[1]": True} if scalar else {"flags": [True, False]}
    found = fmpy.simulate_fmu(str(fmus[fmi]), start_values=start)[-1]
    y = [found["y[1]"], found["y[2]"]] if scalar else list(found["y"])
    assert y == pytest.approx([2 * STATE_AT_2 + 2 * 7, 0.5 + 3 * 5], rel=1e-9)
    assert found["z"] == pytest.approx(303.15, rel=1e-15)
    assert found["w"] == pytest.approx(STATE_AT_2 * 2, rel=1e-9)
    assert found["state"] == 3


LOOPS = """package Small
  model Plant
    input Real u(unit="1", start=2) "Right side of the loop";
    input Real v(unit="1", start=1) "Right side of the cube";
    parameter Real q(unit="1", fixed=false, start=3) "Found at the start";
    output Real a(unit="1") "Of the loop";
    output Real c(unit="1") "Of a state";
    output Real d(unit="1") "Of the cube";
    Real b(unit="1"), x(unit="1"), s(unit="1", start=7), w(unit="1", start=4, fixed=true);
  initial equation
    x = 2*q;
    q = 5;
    der(s) = 0;
  equation
    a + b = u;
    a - 2*b = x;
    c = x;
    d^3 + d = v;
    der(x) = -x;
    der(s) = 3 - s;
    der(w) = 0;
  end Plant;
end Small;
"""


@pytest.fixture(scope="module")
def loops(tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("loops") / "Small"
    root.mkdir()
    (root / "package.mo").write_text(LOOPS, encoding="utf-8")
    return small_fmu("Small.Plant", root)


def test_dependencies_lead_through_systems_of_equations(loops):
    outputs = fmpy.read_model_description(str(loops)).outputs
    found = {o.variable.name: {d.name for d in o.dependencies} for o in outputs}
    assert found == {"a": {"u"}, "c": set(), "d": {"v"}}


def test_what_initial_equations_find_is_calculated(loops):
    found = described(loops)
    assert (found["q"].causality, found["q"].initial) == ("calculatedParameter", "calculated")
    assert [found[name].initial for name in ("x", "s")] == ["calculated", "calculated"]
    assert (found["w"].initial, found["w"].start) == ("exact", "4.0")
    assert validate_fmu(str(loops)) == []
