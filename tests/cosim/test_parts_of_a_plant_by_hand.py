"""Axes, probes and values of a plant made by hand: what is missing, turned round or held."""

import ctypes
import math
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu, Values, axis_of
from tests.cosim.test_probes_by_hand import Rig, Switch

from axisrig.kernel.cosim.fmi import roles
from axisrig.kernel.cosim.fmi.library import Layout
from axisrig.kernel.cosim.fmi.role_table import role_table
from axisrig.kernel.cosim.fmi.roles import Bound, ConvertedExchange, Source, bind
from axisrig.kernel.cosim.plant import probe
from axisrig.kernel.cosim.plant.axis import GAIN_M_S2, STOP_SPEED_M_S, PlantAxis
from axisrig.kernel.cosim.plant.outputs import AXIS_OUTPUTS, POSITION
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

# Outputs of an axis

TOLD: dict[str, Any] = {name: float(n) for n, name in enumerate(AXIS_OUTPUTS, 1)}


@pytest.mark.parametrize(
    ("missing", "instead"),
    [
        ((), {}),
        (("velocity",), {"velocity": 0.0}),  # it rests at 1 m
        (("motor_position",), {"motor_position": 1.0}),
        (("motor_velocity",), {"motor_velocity": 0.0}),  # the motor rests at 3 m
        (("motor_position", "motor_velocity"), {"motor_position": 1.0, "motor_velocity": 2.0}),
        (("demand_position",), {"demand_position": 3.0}),  # it was to stay where its motor is
        (("force",), {"force": 0.0}),
        (("stop_force",), {"stop_force": 0.0}),
        (("stop_face",), {"stop_face": 0.0}),
        (("stop_force", "stop_face"), {"stop_force": 0.0, "stop_face": 0.0}),
        (("demand_position", "stop_force"), {"demand_position": 3.0, "stop_force": 0.0}),
        (("velocity", "force"), {"velocity": 0.0, "force": 0.0}),
        (AXIS_OUTPUTS[1:], {
            "velocity": 0.0, "motor_position": 1.0, "motor_velocity": 0.0, "demand_position": 1.0,
            **dict.fromkeys(("force", "stop_force", "stop_face"), 0.0),
        }),
    ],
)  # fmt: skip
def test_each_output_has_its_place_whatever_the_fmu_does_not_report(
    missing: tuple[str, ...], instead: dict[str, float]
) -> None:
    """Also where what is missing is between others."""
    fmu = Fmu(*RAMP, **{name: value for name, value in TOLD.items() if name not in missing})
    axis = axis_of(fmu)
    expected = [(TOLD | instead)[name] for name in AXIS_OUTPUTS]
    for end_ms in (1, 2, 3):
        axis.step_to(end_ms * MS)
        assert axis.motion == pytest.approx(expected), end_ms
    assert axis.force_n() == (None if "force" in missing else TOLD["force"])


# A stop


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("speed_m_s", [0.0, 0.5, -0.5])
@pytest.mark.parametrize("gap_m", [1e-3, 10e-3])
def test_steps_are_fine_from_where_a_stop_on_either_side_can_be_touched(
    side: int, speed_m_s: float, gap_m: float
) -> None:
    """The way of a motion that comes nearer with |v| + v_stop and the highest gain of speed."""
    fmu = Fmu(*RAMP, position=0.3, velocity=speed_m_s, stop_force=0.0, stop_face=0.3 + side * gap_m)
    axis = axis_of(fmu)
    nearing_m_s = abs(speed_m_s) + STOP_SPEED_M_S

    def way_m(time_s: float) -> float:
        return nearing_m_s * time_s + GAIN_M_S2 * time_s * time_s / 2.0

    last_us = max(t for t in range(0, 20_000, 10) if way_m(t * 1e-6) < gap_m)
    axis.step_to(last_us * US)
    assert fmu.steps == [last_us * US]
    axis = axis_of(Fmu(*RAMP, position=0.3, velocity=speed_m_s, stop_force=0.0,
                       stop_face=0.3 + side * gap_m))  # fmt: skip
    end_us = last_us + 20
    axis.step_to(end_us * US)
    steps = axis.slave.steps  # type: ignore[attr-defined]
    assert len(steps) == math.ceil(end_us * US / axis.fine_ns)
    assert steps[-1] == end_us * US


# A second encoder


def axis_fmu(name: str, **outputs: Any) -> Fmu:
    fmu = Fmu(*RAMP, **outputs)
    fmu.name = name
    return fmu


def test_a_second_encoder_sees_the_load_and_not_the_motor() -> None:
    """Where the shaft between both is twisted they differ."""
    plant = Plant()
    own = axis_fmu("own", position=0.1, motor_position=0.2)
    other = axis_fmu("other", position=0.75, motor_position=0.5)
    plant.add_axis(own, own.roles, "other")  # type: ignore[arg-type]
    plant.add_axis(other, other.roles, "other")  # type: ignore[arg-type]
    for axis in plant.axes.values():
        axis.start(0)
    assert [axis.second_encoder_m() for axis in plant.axes.values()] == [0.75, 0.75]
    assert plant.axes["other"].motor_position_m() == 0.5


# A probe


class Early(Switch):
    """An FMU that ends its step at each change of its level."""

    def __init__(self, changes_us: tuple[int, ...]) -> None:
        self._changes_ns = [at_us * US for at_us in changes_us]
        super().__init__(
            "z", lambda ns, _x: sum(at_ns <= ns for at_ns in self._changes_ns) % 2 == 1,
            can_save=False,
        )  # fmt: skip

    def step_towards(self, end_ns: int) -> int:
        self.step_to(min([at for at in self._changes_ns if at > self.time_ns] + [end_ns]))
        return self.time_ns


@pytest.mark.parametrize(
    ("changes_us", "most"),
    [((), 0), ((10,), 1), ((10, 30), 1), ((5, 10, 30), 2), ((5, 10, 30, 40), 2), ((50,), 1)],
)
def test_edges_of_a_step_are_counted_by_their_direction(
    changes_us: tuple[int, ...], most: int
) -> None:
    """The most of one kind counts: only several of one kind need shorter steps."""
    rig = Rig(Early(changes_us), "z")
    assert rig.step(50 * US, (0.0, 0.0)) == most
    assert rig.probe.signal.edges == [
        (at_us * US, number % 2 == 0) for number, at_us in enumerate(changes_us)
    ]


@pytest.mark.parametrize("was_on", [True, False])
def test_an_order_to_a_held_supply_is_kept_and_not_written(
    was_on: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(probe, "Exchange", lambda fmu, names: Values(fmu, tuple(names)))
    fmu = Switch("z", lambda _ns, _x: False, supply=float(was_on), clearance=1.0)
    rig = Rig(fmu, "z")
    assert rig.probe.is_switched_on is was_on
    rig.probe.is_supply_held = True
    before = len(fmu.written)
    rig.probe.switch(not was_on, 0)
    assert rig.probe.is_switched_on is not was_on
    assert len(fmu.written) == before
    rig.probe.is_supply_held = False
    rig.probe.switch(not was_on, 0)  # known already: nothing to do
    assert len(fmu.written) == before
    rig.probe.switch(was_on, 0)
    assert rig.probe.is_switched_on is was_on
    assert fmu.inputs["switched_on"] == float(was_on)


# Units and types


def slave_with(unit: str, kind: str = "Float64", causality: str = "output") -> Any:
    variable = SimpleNamespace(
        name="v", unit=unit, declaredType=None, causality=causality, type=kind, shape=None
    )
    return SimpleNamespace(
        description=SimpleNamespace(unitDefinitions=[]), variable=lambda _name: variable,
        TYPES=("Float64", "Int32", "Boolean"), names=lambda _causality: ["v"],
    )  # fmt: skip


def role_of(name: str) -> Any:
    return next(role for role in role_table() if role.role == name and role.kind == "axis")


@pytest.mark.parametrize("lead_m", [0.005, 0.010, 0.040])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("role", "unit", "si_of_one"),
    [
        # A screw gives F = 2 pi T / lead, x = lead phi / 2 pi
        ("force", "N.m", lambda lead_m: 2.0 * math.pi / lead_m),
        ("position", "rad", lambda lead_m: lead_m / (2.0 * math.pi)),
        ("motor_velocity", "rad/s", lambda lead_m: lead_m / (2.0 * math.pi)),
    ],
)
def test_a_screw_turns_angles_into_ways_and_torques_into_forces(
    role: str, unit: str, si_of_one: Any, sign: int, lead_m: float
) -> None:
    bound = bind(slave_with(unit), role, role_of(role), Source("v", sign=sign, lead_m=lead_m))
    assert bound.to_si(2.5) == pytest.approx(sign * 2.5 * si_of_one(lead_m))
    assert bound.from_si(bound.to_si(-0.75)) == pytest.approx(-0.75)


@pytest.mark.parametrize(("role", "unit"), [("position", "N.m"), ("force", "rad"), ("force", "N")])
def test_a_lead_is_for_rotations_of_what_is_needed(role: str, unit: str) -> None:
    with pytest.raises(UserError):
        bind(slave_with(unit), role, role_of(role), Source("v", lead_m=0.01))


class Whole:
    """Whole numbers of an FMU."""

    def __init__(self, _slave: Any, names: list[str]) -> None:
        self.values: Any = (ctypes.c_int32 * len(names))()

    def read(self) -> None:
        pass

    def write(self) -> None:
        pass


def test_a_value_that_an_fmu_takes_as_a_whole_number_is_the_nearest_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """3 um are 2.9999999999999996 of 1e-6 m: the FMU counts 3."""
    made: list[Whole] = []

    def whole(slave: Any, names: list[str]) -> Whole:
        made.append(Whole(slave, names))
        return made[-1]

    monkeypatch.setattr(roles, "Exchange", whole)
    bound = [Bound("a", 1e-6), Bound("b", -1e-3)]
    exchange = ConvertedExchange(slave_with("um", "Int32"), bound)
    (own,) = made
    for count in (*range(-1000, 1001, 7), 999_999):
        exchange.values[0], exchange.values[1] = count * 1e-6, count * 1e-3
        exchange.write()
        assert list(own.values) == [count, -count]
        exchange.read()
        assert list(exchange.values) == pytest.approx([count * 1e-6, count * 1e-3])


@pytest.mark.parametrize(
    ("shapes", "places"),
    [((None,), 1), ((None, None), 2), (((3,),), 3), (((2, 3), None), 7), (((1,), (2, 2, 2)), 9)],
)
def test_an_array_takes_as_many_places_as_it_has_elements(shapes: Any, places: int) -> None:
    variables: Any = [
        SimpleNamespace(name=f"v{at}", type="Float64", valueReference=10 + at, shape=shape)
        for at, shape in enumerate(shapes)
    ]
    types = {"Float64": ("Float64", ctypes.c_double), "Int32": ("Int32", ctypes.c_int32)}
    layout = Layout.of(variables, types, "a.fmu")
    assert (layout.word, layout.kind, layout.places) == ("Float64", ctypes.c_double, places)
    assert layout.references == list(layout.array) == [10 + at for at in range(len(shapes))]
    variables[0].type = "String"
    with pytest.raises(UserError, match=r"FMU a\.fmu: v0.* cannot be exchanged"):
        Layout.of(variables, types, "a.fmu")


def test_an_axis_rests_where_it_is_at_the_start() -> None:
    axis = PlantAxis(Fmu(*RAMP, position=-0.4).roles, lambda _ns: None)
    axis.start(5 * MS)
    assert axis.motion[POSITION] == axis.position_m() == -0.4
