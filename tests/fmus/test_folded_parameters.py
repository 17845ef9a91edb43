"""Parameters whose value the compiler has used: told, never taken without an effect."""

from types import SimpleNamespace

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from tests.small_fmus import small_fmu

from axisrig.fmus.writing import fixed_parameters

LIBRARY = """package Small
  model Held
    parameter Boolean b = false "Holds z where full";
    parameter Boolean also = false "Decided in one equation, read in another";
    parameter Boolean bound = not also "Follows";
    parameter Real gain = 3 "Read";
    parameter Real radius = 0 "Decides which equations there are";
    parameter Integer spare = 2 "In no equation";
    parameter Real k[3] = {1, 2, 3} "The last one is in no equation";
    parameter Real twice = 2*gain "Shown only";
    parameter Real alone = 4 "For what is shown only";
    parameter Real shown = 2*alone "Shown only";
    discrete output Real z(start=0, fixed=true) "Noted";
    discrete output Real w(start=0, fixed=true) "Noted";
    discrete output Boolean full(start=false, fixed=true);
    output Real y;
    output Real q;
    Real x;
  equation
    when time > 0.5 then
      z = if b and pre(full) then pre(z) else gain*time;
      w = if also and pre(full) then pre(w) else 1;
    end when;
    full = time > 0.3;
    y = if also then k[1] else k[2];
    q = if bound then 1 else time;
    if radius > 0 then
      der(x) = radius;
    else
      x = 0;
    end if;
  end Held;
  model Inner
    parameter Real k[2] = {1, 2} "Rates";
    output Real y = k[1] + 10*k[2];
  end Inner;
  model Outer
    parameter Real k[2] = {3, 4} "Rates";
    Inner part(k = k);
  end Outer;
  model Shared
    Outer whole(k = {5, 6});
    output Real y = whole.part.y;
  end Shared;
end Small;
"""


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    folder = tmp_path_factory.mktemp("folded")
    root = folder / "Small"
    root.mkdir()
    (root / "package.mo").write_text(LIBRARY, encoding="utf-8")

    def built(model, fmi="3.0"):
        return small_fmu(model, root, fmi=fmi)

    return built


@pytest.mark.parametrize(
    ("name", "value", "found"),
    [
        ("b", True, "b = 1 has no effect in this FMU: the compiler has used its value 0"),
        ("also", True, "also = 1 has no effect in this FMU: the compiler has used its value 0"),
        ("spare", 3, "spare = 3 has no effect in this FMU: the compiler has used its value 2"),
        ("k", [1.0, 2.0, 4.0], "k = 4 has no effect in this FMU: the compiler has used its value"),
        ("radius", 1.0, "radius cannot be set"),
    ],
)
def test_another_value_is_refused(load, build, name, value, found):
    path = build("Small.Held")
    with pytest.raises(FMICallException):
        load(path, **{name: value})
    fmu = load(path)
    fmu.slave.reset()
    fmu.slave.enterInitializationMode()
    with pytest.raises(FMICallException):
        fmu.set(**{name: value})
    assert found in fmu.messages[-1]


def test_the_value_that_it_has_is_taken_and_the_others_act(load, build):
    fmu = load(
        build("Small.Held"),
        **{"b": False, "also": False, "spare": 2, "gain": 4.0, "k": [7.0, 8.0, 3.0], "alone": 5.0},
    )
    fmu.step(1.0)
    assert (fmu.z, fmu.w, fmu.y, fmu.q) == (pytest.approx(2.0, abs=1e-9), 1, 8, 1)
    assert (fmu.get("twice"), fmu.get("shown")) == (8, 10)


def test_the_description_says_so(build):
    described = {
        v.name: (v.description or "", v.variability)
        for v in fmpy.read_model_description(str(build("Small.Held"))).modelVariables
    }
    silent = {name for name, (text, _) in described.items() if "no effect in this FMU" in text}
    assert silent == {"b", "also", "spare", "k"}
    assert described["radius"][1] == "constant"


def test_each_element_speaks_for_itself_in_version_2(build, tmp_path):
    """FMI 2.0 has no arrays: k[3] is refused, k[1] is taken."""
    path = build("Small.Held", "2.0")
    description = fmpy.read_model_description(str(path))
    references = {v.name: v.valueReference for v in description.modelVariables}
    silent = [v.name for v in description.modelVariables if "no effect" in (v.description or "")]
    assert silent == ["b", "also", "spare", "k[3]"]
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path), str(tmp_path / "unzipped")),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="under test",
    )
    slave.instantiate()
    slave.setReal([references["k[1]"]], [7.0])
    slave.setReal([references["k[3]"]], [3.0])
    for call, name, value in (
        (slave.setReal, "k[3]", 4.0),
        (slave.setBoolean, "b", True),
        (slave.setInteger, "spare", 3),
    ):
        with pytest.raises(FMICallException):
            call([references[name]], [value])
    slave.freeInstance()


def test_an_array_of_the_same_name_follows_the_one_around_it(load, build):
    """The compiler writes the numbers of whole.k in place of whole.part.k = whole.k."""
    fmu = load(build("Small.Shared"), **{"whole.k": [7.0, 8.0]})
    assert fmu.y == 87.0


@pytest.mark.parametrize(
    ("follows", "decided", "read", "lost"),
    [
        # slot 3 is decided; 3 follows from 2, 2 from 1, 1 from 0: all of them go
        ({3: {2}, 2: {1}, 1: {0}}, {3}, {4}, {0, 1, 2, 3}),
        ({3: {2}, 2: {1, 4}, 1: {0}}, {3}, {4}, {0, 1, 2, 3, 4}),
        ({3: {2}, 1: {0}}, {3}, {4, 1}, {2, 3}),
        ({}, set(), {0, 1, 2, 3, 4}, set()),
        ({1: {2}, 2: {1}}, {1}, {0, 3, 4}, {1, 2}),  # a circle ends
        ({}, set(), {0, 2, 4}, {1, 3}),  # what nothing reads
    ],
)
def test_what_a_decided_parameter_follows_from_has_no_effect_at_any_distance(
    monkeypatch, follows, decided, read, lost
):
    rows = [
        SimpleNamespace(index=slot, vector="p", value=sources) for slot, sources in follows.items()
    ]
    system = SimpleNamespace(initial=rows, previous=[])
    slots = {n: f"p{n}" for n in range(5)}
    monkeypatch.setattr(fixed_parameters, "_slots_of_parameters", lambda _: slots)
    monkeypatch.setattr(fixed_parameters, "_programs", lambda _: [read])
    monkeypatch.setattr(fixed_parameters, "_read", lambda values: set().union(*values))
    monkeypatch.setattr(fixed_parameters, "_mentioned", lambda _: ())
    monkeypatch.setattr(fixed_parameters, "_decided", lambda *_: set(decided))
    assert fixed_parameters.folded_slots(None, system) == lost
