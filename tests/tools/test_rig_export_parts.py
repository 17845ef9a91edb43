"""Which plants of a rig hang together, and the text of the model that joins them; nothing is built.

The description of an FMU is written down: its inputs and outputs with their words.
"""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.rig_export.parts import (
    Part,
    Port,
    _declaration,
    _groups,
    _joining,
    _reads_motion,
    _shown,
    _wires,
    unit_of,
)


def described(name: str, causality: str = "output", type_: str = "Float64", **words: Any) -> Any:
    given = {"unit": None, "min": None, "max": None, "start": None, "description": None,
             "declaredType": None}  # fmt: skip
    return SimpleNamespace(name=name, causality=causality, type=type_, **(given | words))


def fmu(*variables: Any) -> Any:
    return SimpleNamespace(modelVariables=list(variables))


def plant(model: str = "AxisRig.Drives.ServoAxis", shares: str | None = None, **wire: str) -> Any:
    suffix = "" if shares is None else "_2"
    return SimpleNamespace(fmu=model, wire=wire, shares=shares, suffix=suffix)


def settings(**plants: Any) -> Any:
    return SimpleNamespace(rig=SimpleNamespace(plant=plants))


@pytest.mark.parametrize(
    ("plants", "groups"),
    [
        ({"x": plant(), "z": plant()}, [(["x"], []), (["z"], [])]),
        ({"x": plant(), "z": plant(), "probe": plant(z="z")}, [(["x"], []), (["z"], ["probe"])]),
        ({"x": plant(), "z": plant(), "probe": plant(x="x", z="z")}, [(["x", "z"], ["probe"])]),
        ({"x": plant(), "y": plant(), "z": plant(), "a": plant(z="z"), "b": plant(y="y", z="z")},
         [(["x"], []), (["y", "z"], ["a", "b"])]),
        ({"x": plant(), "y": plant(), "a": plant(x="x"), "b": plant(y="y"),
          "c": plant(x="y", y="x")},
         [(["x", "y"], ["a", "b", "c"])]),
        # One FMU of two axes: a sensor on the second one is of the first
        ({"x": plant(), "gantry": plant(), "probe": plant(z="second")},
         [(["x"], []), (["gantry"], ["probe"])]),
    ],
)  # fmt: skip
def test_axes_and_their_sensors_hang_together(
    plants: dict[str, Any], groups: list[tuple[list[str], list[str]]]
) -> None:
    whole = settings(**plants, second=plant(shares="gantry"))
    found = _groups(whole, plants)
    assert [(group.axes, group.sensors) for group in found] == groups


def test_a_sensor_gets_the_motion_of_its_axes() -> None:
    """Begin and end of a step are those of now; a coordinate without an axis rests at 0."""
    whole = settings(z=plant(), gantry=plant(), second=plant(shares="gantry"),
                     probe=plant(z="z", x="second"))  # fmt: skip
    names = ["step_time", "step_size", "other"]
    names += [f"{letter}_{end}" for letter in "xyz" for end in ("start", "rate_end")]
    found = _wires(whole, "probe", fmu(*(described(name, "input") for name in names)))
    assert found == {
        "step_time": "time", "step_size": "1", "x_start": "gantry.position_2",
        "x_rate_end": "gantry.velocity_2", "y_start": "0", "y_rate_end": "0",
        "z_start": "z.position", "z_rate_end": "z.velocity",
    }  # fmt: skip


def test_what_a_part_shows() -> None:
    made = fmu(described("a", "input"), described("b"), described("c", "parameter"),
               described("d", "input"), described("e", "local"))  # fmt: skip
    assert [v.name for v in _shown(made, frozenset())] == ["a", "b", "d"]
    assert [v.name for v in _shown(made, frozenset(["d"]))] == ["a", "b"]
    step = [described("step_time"), described("step_size")]
    assert _reads_motion(fmu(*step, described("x")))
    assert not _reads_motion(fmu(step[0]))
    assert Part("z", ("z",), "AxisRig.Drives.ServoAxis", ()).parameter("z", "kv") == "kv"
    assert Part("z", ("z", "probe"), None, ()).parameter("probe", "surface") == "probe.surface"


@pytest.mark.parametrize(
    ("variable", "text"),
    [
        (described("v"), 'output Real p_v "";'),
        (described("v", unit="m", description='the "way"'),
         """output Real p_v(unit = "m") "the 'way'";"""),
        (described("v", "input", unit="m", min="-1.0", max="2.0", start="0.5"),
         'input Real p_v(unit = "m", min = -1.0, max = 2.0, start = 0.5) "";'),
        (described("v", start="0.5"), 'output Real p_v "";'),  # an output begins as it is computed
        (described("v", "input", "Boolean", min="0", max="1", start="true"),
         'input Boolean p_v(start = true) "";'),
        (described("v", "output", "Int32", max="3"), 'output Integer p_v(max = 3) "";'),
        (described("v", declaredType=SimpleNamespace(unit="rad")),
         'output Real p_v(unit = "rad") "";'),
    ],
)  # fmt: skip
def test_a_port_has_the_words_of_its_variable(variable: Any, text: str) -> None:
    assert _declaration(Port("p_v", "p", variable)) == f"  {text}"


def test_the_unit_is_that_of_the_variable_before_that_of_its_type() -> None:
    declared = SimpleNamespace(unit="m")
    assert unit_of(described("v", unit="mm", declaredType=declared)) == "mm"
    assert unit_of(described("v", declaredType=declared)) == "m"
    assert unit_of(described("v")) is None


@pytest.mark.parametrize(
    ("model", "lines"),
    [("AxisRig.Sensors.TouchProbe", []), ("own/Feeler.mo", ["  import AxisRig;"])],
)
def test_the_model_that_joins_plants(model: str, lines: list[str]) -> None:
    """Inputs go in, outputs come out; levels of sensors may end a step early, of axes not."""
    whole = settings(z=plant(), probe=plant(model, z="z"))
    ports = [
        Port("z_demand", "z", described("demand", "input")),
        Port("z_touching", "z", described("touching", "output", "Boolean")),
        Port("probe_signal", "probe", described("signal", "output", "Boolean")),
        Port("probe_touching", "probe", described("touching", "output", "Boolean")),
        Port("probe_force", "probe", described("force")),
    ]
    wired = {"probe": {"z_start": "z.position", "step_size": "1"}}
    kind = model if not lines else "Feeler"
    assert _joining(whole, "Rig_z", ("z", "probe"), wired, ports).splitlines() == [
        'model Rig_z "Plants z, probe of a rig"',
        *lines,
        "  AxisRig.Drives.ServoAxis z;",
        f"  {kind} probe;",
        *(_declaration(port) for port in ports),
        "equation",
        "  probe.z_start = z.position;",
        "  probe.step_size = 1;",
        "  z.demand = z_demand;",
        "  z_touching = z.touching;",
        "  probe_signal = probe.signal;",
        "  probe_touching = probe.touching;",
        "  probe_force = probe.force;",
        '  annotation(__axisrig(returns_early = "probe_signal, probe_touching"));',
        "end Rig_z;",
    ]
