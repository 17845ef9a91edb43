"""An axis as a drive commands it: position, velocity, force, limits; its second encoder."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from axisrig.fmus import ensure_built
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.fmi.roles import Source, map_roles
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS

MASS = 120 + 1.8e-4 * (2 * math.pi / 0.01) ** 2  # kg
FREE = {"coulomb_friction": 0.0, "breakaway_friction": 0.0, "viscous_friction": 0.0}


@pytest.fixture
def make() -> Iterator[Callable[..., PlantAxis]]:
    """Make the axis of an FMU with start values, its plant at time 0."""
    plants = []

    def made(
        path: Path,
        sources: dict[str, Source | None] | None = None,
        second_encoder: str | None = None,
        **start: float,
    ) -> PlantAxis:
        slave = load_fmu(path, "axis")
        for name, value in start.items():
            slave.set_start(name, value)
        plant = Plant()
        plants.append(plant)
        axis = plant.add_axis(slave, map_roles(slave, "axis", sources or {}), second_encoder)
        plant.initialize(0)
        return axis

    yield made
    for plant in plants:
        plant.close()


@pytest.fixture(params=["3.0", "2.0"], ids=["FMI3", "FMI2"])
def servo(request, make) -> PlantAxis:
    return make(ensure_built("AxisRig.Drives.ServoAxis", fmi=request.param), **FREE)


def test_an_axis_of_the_library_offers_every_kind_of_control(servo) -> None:
    assert servo.kinds == set(ControlKind)
    assert servo.limits_force


def test_velocity_follows_its_ramp_and_rests(servo) -> None:
    servo.command_velocity(0, 0.01, 0.2, 200 * MS)
    servo.advance_to(150 * MS)
    assert servo.motor_velocity_m_s() == pytest.approx(0.01 + 0.2 * 0.15, abs=1e-7)
    assert servo.force_n() == pytest.approx(MASS * 0.2, rel=1e-4)
    servo.advance_to(800 * MS)
    assert servo.motor_velocity_m_s() == pytest.approx(0.05, abs=1e-9)
    assert servo.demand_position_m() == servo.motor_position_m()


def test_a_demanded_force_acts_within_its_limits(servo) -> None:
    """Newton: in 100 ms the velocity changes by F/m t, wherever the limit of the direction lies."""
    asked = ((400.0, 400.0), (-400.0, -90.0), (1200.0, 700.0))
    servo.limit_force(90.0, 700.0)
    for k, (force_n, given_n) in enumerate(asked):
        servo.advance_to(k * 100 * MS)
        servo.command_force(k * 100 * MS, force_n)
        servo.advance_to((k * 100 + 50) * MS)
        before = servo.motor_velocity_m_s()
        servo.advance_to((k * 100 + 100) * MS)
        assert servo.force_n() == pytest.approx(given_n, rel=1e-9)
        gained = servo.motor_velocity_m_s() - before
        assert gained == pytest.approx(given_n / MASS * 0.05, rel=1e-9)


def test_position_control_takes_over_and_back(servo) -> None:
    servo.command_velocity(0, 0.05, 0.0, 0)
    servo.advance_to(500 * MS)
    here_m = servo.motor_position_m()
    servo.command(500 * MS, here_m, 0.0, 500 * MS, True)
    servo.advance_to(2000 * MS)
    assert servo.demand_position_m() == here_m
    assert servo.motor_position_m() == pytest.approx(here_m, abs=1e-8)
    servo.command_velocity(2000 * MS, -0.05, 0.0, 2000 * MS)
    servo.advance_to(2500 * MS)
    assert servo.motor_velocity_m_s() == pytest.approx(-0.05, abs=1e-7)
    assert servo.demand_position_m() == servo.motor_position_m()


def test_after_each_other_kind_of_control_a_ramp_ends_where_it_was_to_end(servo) -> None:
    """Position, velocity, position, force, position: 2 mm further each time, to 0.1 um."""
    time_ns, kinds = 0, []
    for other in ("", "velocity", "", "force"):
        if other == "velocity":
            servo.command_velocity(time_ns, 0.02, 0.0, time_ns)
        elif other:
            servo.command_force(time_ns, 30.0)
        kinds.append(servo.slave.get("control"))
        servo.advance_to(time_ns + 50 * MS)
        here_m = servo.motor_position_m()
        begin_ns = time_ns + 50 * MS
        servo.command(begin_ns, here_m, 0.02, begin_ns + 100 * MS, True)
        assert servo.slave.get("control") == ControlKind.POSITION.value
        time_ns = begin_ns + 2500 * MS
        servo.advance_to(time_ns)
        assert servo.demand_position_m() == pytest.approx(here_m + 0.002, abs=1e-12)
        assert servo.motor_position_m() == pytest.approx(here_m + 0.002, abs=1e-7)
    assert kinds == [0, ControlKind.VELOCITY.value, 0, ControlKind.FORCE.value]


def test_power_off_ends_every_kind_of_control(servo) -> None:
    for k, begin in enumerate((servo.command_velocity, servo.command_force)):
        time_ns = k * 200 * MS
        args = (0.05, 0.0, time_ns) if k == 0 else (300.0,)
        begin(time_ns, *args)
        servo.advance_to(time_ns + 50 * MS)
        assert servo.force_n() != pytest.approx(0.0, abs=1e-3)
        servo.command(time_ns + 50 * MS, servo.motor_position_m(), 0.0, time_ns, False)
        servo.advance_to(time_ns + 150 * MS)
        assert servo.force_n() == pytest.approx(0.0, abs=1e-9)


def test_a_table_in_degrees_turns_a_torque_into_a_force_along_its_travel(make) -> None:
    """1 degree is 1 mm: 57.3 N along it are 57.3 N 0.36 m/(2 pi) = 3.28 N.m at the table."""
    names = (
        *("reference_position", "reference_velocity", "reference_acceleration"),
        *("reference_force", "force", "force_limit_negative", "force_limit_positive"),
        *("position", "velocity", "motor_position", "motor_velocity", "demand_position"),
    )
    sources = {name: Source(name, lead_m=0.36) for name in names}
    free = {f"{name}_friction": 0.0 for name in ("coulomb", "breakaway", "viscous")}
    table = make(ensure_built("AxisRig.Drives.RotaryAxis"), sources, **free)
    assert table.kinds == set(ControlKind)
    lever_m = 0.36 / (2 * math.pi)
    table.command_force(0, 3.0 / lever_m)
    table.advance_to(100 * MS)
    assert table.force_n() == pytest.approx(3.0 / lever_m, rel=1e-9)
    before = table.motor_velocity_m_s()
    table.advance_to(200 * MS)
    gained_rad_s = (table.motor_velocity_m_s() - before) / lever_m
    assert gained_rad_s == pytest.approx(3.0 / (0.5 + 1.8e-4 * 60**2) * 0.1, rel=1e-9)
    table.limit_force(1e9, 2.0 / lever_m)
    table.advance_to(300 * MS)
    assert table.force_n() == pytest.approx(2.0 / lever_m, rel=1e-9)


def test_a_torque_without_its_lead_is_left_out_and_told(make) -> None:
    """The four names of the table that are torques or rad/s2 are not taken for N and m/s2."""
    names = (
        *("reference_position", "reference_velocity"),
        *("position", "velocity", "motor_position", "motor_velocity", "demand_position"),
    )
    sources = {name: Source(name, lead_m=0.36) for name in names}
    table = make(ensure_built("AxisRig.Drives.RotaryAxis"), sources)
    assert table.kinds == {ControlKind.POSITION}
    assert not table.limits_force
    assert table.force_n() is None
    found = [note for note in table.roles.notes if "is not taken" in note]
    assert any(note.startswith("reference_force of the FMU is not taken") for note in found)


def test_an_fmu_with_a_plain_demand_offers_position_control(fmu, make) -> None:
    sources = {"demand": Source("control.s_set"), "position": Source("table.s")}
    table = make(fmu("table"), sources)
    assert table.kinds == {ControlKind.POSITION}
    assert not table.limits_force
    table.limit_force(1.0, 2.0)  # has nowhere to go
    assert table.force_n() is None


def test_one_limit_for_both_directions_gets_the_smaller_amount(make) -> None:
    sources = {"force_limit_negative": None, "force_limit_positive": None}
    axis = make(ensure_built("AxisRig.Drives.ServoAxis"), sources)
    assert axis.limits_force
    axis.limit_force(70.0, 90.0)
    assert axis.slave.get("force_limit") == 70.0


def test_a_second_encoder_is_what_is_wired_to_it(servo, make) -> None:
    assert servo.second_encoder_m() is None
    servo = make(ensure_built("AxisRig.Drives.ServoAxis"), second_encoder="axis", **FREE)
    servo.command_velocity(0, 0.05, 0.0, 0)
    servo.advance_to(100 * MS)
    assert servo.second_encoder_m() == servo.position_m() > 1e-3
