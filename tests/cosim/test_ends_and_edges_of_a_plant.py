"""Small forces, late starts, motors that are not the load, two axes before one probe: by hand."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu, axis_of
from tests.cosim.test_loads_and_times_of_a_plant import Pathway
from tests.cosim.test_probes_by_hand import Rig, Switch
from tests.cosim.test_steps_of_a_plant import EXCHANGE_NS, FINE_NS, Probe, axis_fmu, plant_of

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.edges import Trajectory
from axisrig.kernel.cosim.plant.plant import Plant, refuse_held_outputs
from axisrig.kernel.time.clock import MS, US, S

pytestmark = pytest.mark.interpreted


@pytest.mark.parametrize("force_n", [1e-6, 0.5, 1.0, 2000.0])
def test_the_smallest_force_of_a_stop_is_one(force_n: float) -> None:
    fmu = Fmu(*RAMP, position=0.3, velocity=0.0, motor_position=0.3, motor_velocity=0.0,
              demand_position=0.3, force=7.0, stop_force=force_n, stop_face=0.3)  # fmt: skip
    axis = axis_of(fmu)
    axis.step_to(MS)
    assert axis.stop_force_peak_n(0, MS) == pytest.approx(force_n, rel=1e-9)
    assert axis.stop_force_peak_n(2 * MS, 3 * MS) == 0.0
    assert axis.force_n() == 7.0


@pytest.mark.parametrize("start_ns", [0, MS, 10 * S])
def test_a_stop_is_as_far_away_whenever_a_run_begins(start_ns: int) -> None:
    """10 mm at rest: 4 ms in one step, behind them fine ones."""
    fmu = Fmu(*RAMP, position=0.3, velocity=0.0, stop_force=0.0, stop_face=0.31)
    axis = PlantAxis(fmu.roles, lambda _ns: None)
    axis.start(start_ns)
    axis.step_to(start_ns + 4 * MS)
    assert fmu.steps == [start_ns + 4 * MS]
    axis.step_to(start_ns + 12 * MS)
    assert len(fmu.steps) > 8 * MS // axis.fine_ns


def test_power_is_switched_once_for_however_many_commands() -> None:
    fmu = Fmu(*RAMP, "enabled", "control", "reference_acceleration", "reference_force",
              position=0.0, velocity=0.0)  # fmt: skip
    axis = axis_of(fmu)

    def switched() -> list[float]:
        return [values["enabled"] for _, values in fmu.written if "enabled" in values]

    for number in range(3):
        axis.command_velocity(number * MS, 0.5, 1.0, (number + 1) * MS)
    axis.command_force(3 * MS, 20.0)
    assert switched() == [1.0]
    axis.command(4 * MS, 0.0, 0.0, 5 * MS, enabled=False)
    axis.command_force(5 * MS, 20.0)
    assert switched() == [1.0, 0.0, 1.0]


def test_a_motor_encoder_reads_the_place_of_the_motor() -> None:
    """The motor at 0.7 m and 2 m/s, the load at 0.3 m and 1 m/s; 2 ms a step."""
    fmu = Fmu(*RAMP, position=lambda ns: 0.3 + ns * 1e-9, velocity=1.0,
              motor_position=lambda ns: 0.7 + 2 * ns * 1e-9, motor_velocity=2.0)  # fmt: skip
    axis = axis_of(fmu)
    axis.step_to(2 * MS)
    axis.step_to(4 * MS)
    for at_ns in (0, MS, 2 * MS, 3 * MS):
        assert axis.motor_position_m_at(at_ns) == pytest.approx(0.7 + 2 * at_ns * 1e-9, abs=1e-12)


# A plant


@pytest.mark.parametrize(("exchange_us", "is_followed"), [(50, True), (40, True), (51, False)])
def test_where_steps_are_fine_anyhow_every_probe_is_followed(
    exchange_us: int, is_followed: bool
) -> None:
    """fine_us = exchange_us is what a message about a lost edge asks for."""
    plant, fmu, probe = Plant(exchange_us * US, 50 * US), axis_fmu("axis_x"), Probe(free_ns=None)
    plant.add_axis(fmu, fmu.roles)
    plant.probes["tip"] = probe  # type: ignore[assignment]
    plant.initialize()
    plant.advance_to(200 * US)
    assert bool(probe.steps) is is_followed
    assert bool(probe.passed) is not is_followed


@pytest.mark.parametrize("start_ns", [0, 7 * MS])
def test_probes_begin_when_their_plant_does(start_ns: int) -> None:
    plant, fmu, probe = Plant(EXCHANGE_NS, FINE_NS), axis_fmu("axis_x"), Probe()
    plant.add_axis(fmu, fmu.roles)
    plant.probes["tip"] = probe  # type: ignore[assignment]
    plant.initialize(start_ns)
    assert (probe.free_until_ns, plant.now_ns, fmu.time_ns) == (start_ns,) * 3


@pytest.mark.parametrize("fine_us", [10, 50, 200])
def test_all_axes_of_a_plant_have_its_fine_step(fine_us: int) -> None:
    """Also one that is longer than that of an axis alone."""
    plant = Plant(EXCHANGE_NS, fine_us * US)
    for name in ("axis_x", "axis_y"):
        fmu = axis_fmu(name)
        plant.add_axis(fmu, fmu.roles)
    plant.initialize()
    assert [axis.fine_ns for axis in plant.axes.values()] == [fine_us * US] * 2


def test_a_velocity_that_is_a_derivative_makes_steps_fine_before_a_probe_too() -> None:
    probe, fmu = Probe(free_ns=None), axis_fmu("axis_x", velocity=False)
    plant_of(fmu, probe=probe).advance_to(4 * FINE_NS)
    assert fmu.steps == [number * FINE_NS for number in range(1, 5)]
    assert len(probe.steps) == 4


@pytest.mark.parametrize(
    ("moved_um", "is_good"), [(5.0, True), (7.5, True), (10.05, True), (10.2, False)]
)
def test_a_step_may_go_twice_as_far_as_at_its_higher_speed(moved_um: float, is_good: bool) -> None:
    """0.1 m/s at both ends of 50 us are 5 um; a motion may swing between; 0.1 um is rounding."""
    tick = (0.1, 0.1, 0.1 + moved_um * 1e-6, 0.1)
    axis: Any = SimpleNamespace(tick=tick, name="z")
    if is_good:
        refuse_held_outputs(axis, 0, 50 * US)
    else:
        with pytest.raises(PlantError, match="steps inside more coarsely"):
            refuse_held_outputs(axis, 0, 50 * US)


# Probes


def test_each_axis_before_a_probe_has_its_own_trajectory() -> None:
    names = ["step_time", "step_size"]
    names += [
        f"{axis}_{way}" for axis in "xz" for way in ("start", "rate_start", "end", "rate_end")
    ]
    fmu = Fmu(*names)
    axes: Any = {
        "x": SimpleNamespace(motion=[0.1, 5.0], tick=(0.1, 1.0, 0.2, 2.0)),
        "z": SimpleNamespace(motion=[0.3, 6.0], tick=(0.3, 3.0, 0.4, 4.0)),
    }
    made = Trajectory(fmu.roles, axes)
    made.write_step(MS, 3 * MS)
    values = (0.001, 0.002, 0.1, 1.0, 0.2, 2.0, 0.3, 3.0, 0.4, 4.0)
    assert fmu.inputs == pytest.approx(dict(zip(names, values, strict=True)))
    made.write_rest(3 * MS, 4 * MS)
    values = (0.003, 0.001, 0.1, 0.0, 0.1, 0.0, 0.3, 0.0, 0.3, 0.0)
    assert fmu.inputs == pytest.approx(dict(zip(names, values, strict=True)))


@pytest.mark.parametrize("can_save", [True, False])
def test_an_edge_at_the_end_of_a_whole_step_is_known_to_the_step(can_save: bool) -> None:
    """Without a state to go back to, also for an FMU that has the trajectory."""
    fmu = Pathway(137 * US)
    fmu.can.can_save_state = can_save
    rig = Rig(fmu, "z")
    assert rig.step(400 * US, (0.001, 0.0)) == 1
    assert rig.probe.signal.edges == [(137 * US if can_save else 400 * US, True)]
    assert rig.probe.edge_uncertainty_ns == (1.0 if can_save else 400_000.0)


def test_the_room_of_a_probe_is_used_up_by_the_way_of_each_of_its_axes() -> None:
    """X stands at 0.1 m and Z at 0.5 m: as long as both rest there is all of the clearance."""
    fmu = Switch("xz", lambda _ns, _x: False, clearance=0.02)
    rig = Rig(fmu, "xz")
    rig.place((0.1, 0.0), (0.5, 0.0))
    rig.step(100 * US, (0.1, 0.0), (0.5, 0.0))
    resting_ns = rig.probe.look_ahead(100 * US, 20 * MS) - 100 * US
    assert resting_ns > 5 * MS
    rig.place((0.1, 0.0), (0.51, 0.0))
    fmu.outputs["clearance"] = 0.01
    assert rig.probe.look_ahead(101 * US, 20 * MS) - 101 * US < resting_ns


def test_the_worst_edge_of_an_axis_without_velocity_stays_the_worst() -> None:
    places = iter([(1e-3, 0.0), (2e-3, 0.0)])
    rig = Rig(Switch("z", lambda _ns, x: 0.5e-3 < x[0] < 1.5e-3), "z", tells_velocity=False)
    assert rig.step(40 * US, next(places)) == 1
    assert rig.probe.edge_uncertainty_ns == 40_000.0
    assert rig.step(50 * US, next(places)) == 1
    assert rig.probe.edge_uncertainty_ns == 40_000.0
    assert [level for _, level in rig.probe.signal.edges] == [True, False]
