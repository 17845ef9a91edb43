"""A stop is that of the load; times that a plant hands to its probes; sensors that start late."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu, axis_of
from tests.cosim.test_probes_by_hand import Rig, Switch
from tests.cosim.test_steps_of_a_plant import EXCHANGE_NS, FINE_NS, Sensor, axis_fmu

from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.inputs import parts_of
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import PlantSignal, free_s
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US, S

pytestmark = pytest.mark.interpreted


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("motor_ahead_m", [0.0, 0.05, -0.05])
def test_how_near_a_stop_is_depends_on_the_load_and_not_on_the_motor(
    side: int, motor_ahead_m: float
) -> None:
    """A gap of 10 mm at rest takes 5.3 ms at least: 1 m/s + 500 m/s2 (docs/architecture.md)."""
    fmu = Fmu(*RAMP, position=0.3, velocity=0.0, motor_position=0.3 + side * motor_ahead_m,
              motor_velocity=0.0, demand_position=0.3, force=0.0, stop_force=0.0,
              stop_face=0.3 + side * 0.01)  # fmt: skip
    axis = axis_of(fmu)
    axis.step_to(4 * MS)
    assert fmu.steps == [4 * MS]
    axis.step_to(10 * MS)
    assert len(fmu.steps) == 1 + 6 * MS // axis.fine_ns


@pytest.mark.parametrize(("hold_ns", "look_back_ns"), [(0, 0), (5 * MS, 2 * MS), (0, 7 * US)])
def test_probes_get_the_times_around_an_edge_from_their_plant(
    hold_ns: int, look_back_ns: int
) -> None:
    """For so long a drive looks up motion behind an edge, and for so long before it."""
    plant = Plant(EXCHANGE_NS, FINE_NS, hold_ns, look_back_ns)
    fmu = axis_fmu("axis_x")
    plant.add_axis(fmu, fmu.roles)
    for name in ("one", "two"):
        switch: Any = Switch("z", lambda _ns, _x: False, clearance=0.5)
        switch.name = name
        probe = plant.add_probe(switch, {"z": "axis_x"}, switch.roles)
        assert (probe.hold_ns, probe.look_back_ns) == (hold_ns, look_back_ns)
    assert list(plant.probes) == ["one", "two"]


@pytest.mark.parametrize(
    ("exchange_us", "longest_us"), [(100, 100), (249, 249), (250, 250), (251, 250), (20_000, 250)]
)
def test_a_plant_with_a_sensor_is_not_stepped_by_more_than_it_was_asked_to(
    exchange_us: int, longest_us: int
) -> None:
    fmu, plant = axis_fmu("axis_x"), Plant(exchange_us * US, 50 * US)
    plant.add_axis(fmu, fmu.roles)
    sensor: Any = Sensor()
    plant.distances["sensor"] = sensor
    plant.initialize()
    assert plant.exchange_ns == longest_us * US
    without = Plant(exchange_us * US, 50 * US)
    without.initialize()
    assert without.exchange_ns == exchange_us * US


@pytest.mark.parametrize("start_ns", [0, 5 * MS, 3 * S])
def test_a_sensor_begins_at_rest_over_a_second_from_its_start_on(start_ns: int) -> None:
    """Its trajectory goes from where the axis is to where it is, from now on."""
    names = ("step_time", "step_size", "z_start", "z_rate_start", "z_end", "z_rate_end")
    fmu = Fmu(*names, distance=0.5)
    axis: Any = SimpleNamespace(motion=[0.125, 7.0])
    initialised: list[dict[str, float]] = []
    begin = fmu.initialize

    def initialize(at_ns: int) -> None:
        initialised.append(dict(fmu.inputs))
        begin(at_ns)

    fmu.initialize = initialize  # type: ignore[method-assign]
    fmu.function = lambda *_: None  # type: ignore[attr-defined]
    fmu.grid_ns = 1  # no steps in a row
    sensor = PlantDistance(fmu.roles, {"z": axis})
    sensor.start(start_ns)
    wanted = dict(zip(names, (start_ns * 1e-9, 1.0, 0.125, 0.0, 0.125, 0.0), strict=True))
    assert initialised == [pytest.approx(wanted)]
    assert fmu.time_ns == start_ns
    assert sensor.reported_at(start_ns)[0] == 0.5


def test_each_who_watches_a_signal_is_called_once_for_each_edge() -> None:
    signal, calls = PlantSignal(False), list[tuple[str, int]]()
    for name in "abc":
        signal.watches.append(lambda at_ns, name=name: calls.append((name, at_ns)))
    signal.add(5, True)
    signal.watches.pop(1)
    signal.add(9, False)
    assert calls == [("a", 5), ("b", 5), ("c", 5), ("a", 9), ("c", 9)]


@pytest.mark.parametrize("speed_m_s", [0.0, 0.5])
@pytest.mark.parametrize("gain_m_s2", [500.0, 866.0])
def test_without_room_there_is_no_time_at_rest_either(speed_m_s: float, gain_m_s2: float) -> None:
    assert free_s(0.0, speed_m_s, gain_m_s2) == 0.0
    assert free_s(-1e-9, speed_m_s, gain_m_s2) == 0.0
    assert free_s(1e-12, speed_m_s, gain_m_s2) > 0.0


@pytest.mark.parametrize("grid_ns", [None, MS])
def test_axes_of_one_fmu_take_steps_of_any_length(grid_ns: int | None) -> None:
    """The FMU of a gantry is stepped by its first axis: no grid of it holds for the other one."""
    first, second = axis_fmu("axis_x"), axis_fmu("axis_x")
    second.grid_ns = grid_ns
    plant = Plant(EXCHANGE_NS, FINE_NS)
    plant.add_axis(first, first.roles)
    if grid_ns is None:
        assert plant.add_axis_beside("slave", "axis_x", second.roles).name == "slave"
        assert list(plant.axes) == ["axis_x", "slave"]
        return
    with pytest.raises(UserError, match="must take steps of any length") as caught:
        plant.add_axis_beside("slave", "axis_x", second.roles)
    assert caught.value.value == "slave"
    assert list(plant.axes) == ["axis_x"]


def test_parts_of_a_plant_are_its_axes_probes_and_sensors_by_name() -> None:
    plant: Any = SimpleNamespace(
        axes={"x": SimpleNamespace(roles="of x"), "z": SimpleNamespace(roles="of z")},
        probes={"tip": SimpleNamespace(roles="of tip")},
        distances={"gap": SimpleNamespace(roles="of gap")},
    )
    assert parts_of(plant) == {name: f"of {name}" for name in ("x", "z", "tip", "gap")}


class Pathway(Switch):
    """An FMU that gets the trajectory of a step and reports its level alone; time changes it."""

    def __init__(self, rises_ns: int) -> None:
        super().__init__("z", lambda now_ns, _x: now_ns >= rises_ns)
        ways = ("start", "rate_start", "end", "rate_end")
        names = ("step_time", "step_size", *(f"z_{way}" for way in ways))
        self.inputs = {**self.inputs, **dict.fromkeys(names, 0.0)}
        self.roles.has_group = lambda group: group == "trajectory"


@pytest.mark.parametrize("rises_us", [10, 137, 399])
def test_an_edge_of_a_probe_with_the_trajectory_is_known_to_1_ns_also_where_time_brings_it(
    rises_us: int,
) -> None:
    """It knows where the axis is at every instant of the step: no position is an old one."""
    rig = Rig(Pathway(rises_us * US), "z")
    assert rig.step(400 * US, (0.001, 0.0)) == 1
    assert rig.probe.signal.edges == [(rises_us * US, True)]
    assert rig.probe.edge_uncertainty_ns == 1.0
