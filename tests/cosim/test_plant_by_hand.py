"""Axes and sensors of a plant over FMUs made by hand: what each gets, keeps and reports."""

from collections import deque
from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import GROUPS, RAMP, Fmu, axis_of

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.curves import drop_before, end_slope, hermite, two_before
from axisrig.kernel.cosim.plant.demand import SAMPLE_NS, Control, Ramp, SampledDemand
from axisrig.kernel.cosim.plant.distance import PlantDistance
from axisrig.kernel.cosim.plant.grid import GridAxis
from axisrig.kernel.cosim.plant.outputs import HISTORY_NS
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import PlantSignal, free_s
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US

# Numbers


@pytest.mark.parametrize(
    ("points", "slope"),
    [
        ([(5 * MS, 7.0)], 0.0),
        ([(5 * MS, 7.0), (3 * MS, 6.0)], 500.0),
        # x = 1000 t^2, so 2000 t
        ([(5 * MS, 0.025), (3 * MS, 0.009), (2 * MS, 0.004)], 10.0),
        ([(0, 0.0), (-2 * MS, 0.004), (-3 * MS, 0.009)], 0.0),
    ],
)
def test_the_slope_at_the_end_is_that_of_the_parabola(
    points: Sequence[tuple[int, float]], slope: float
) -> None:
    assert end_slope(points) == pytest.approx(slope, abs=1e-9)


@pytest.mark.parametrize(
    ("now_ms", "apart_ms", "found_ms"),
    [(10, 2, [8, 6]), (10, 3, [7, 4]), (10, 1, [9, 8]), (9, 8, [1]), (9, 9, []), (10, 5, [5])],
)
def test_rows_before_are_so_far_apart_at_least(
    now_ms: int, apart_ms: int, found_ms: list[int]
) -> None:
    times = deque(k * MS for k in range(1, 10))
    rows = deque([float(k)] for k in range(1, 10))
    assert [(t // MS, row) for t, row in two_before(times, rows, now_ms * MS, apart_ms * MS)] == [
        (k, [float(k)]) for k in found_ms
    ]


def test_rows_before_an_instant_go_and_the_one_at_it_stays() -> None:
    times, rows = deque([1, 2, 3, 4]), deque([[1.0], [2.0], [3.0], [4.0]])
    drop_before(times, rows, 3)
    assert (list(times), list(rows)) == ([3, 4], [[3.0], [4.0]])


def test_a_cubic_between_two_points_is_exact() -> None:
    """x = 1 + 2t + 3t² - 4t³ over 2 s: ends 1 and -15, slopes 2 and -34."""
    for time_s in (0.0, 0.25, 1.0, 1.75, 2.0):
        expected = 1 + 2 * time_s + 3 * time_s**2 - 4 * time_s**3
        assert hermite(time_s, 2.0, (1.0, 2.0, -15.0, -34.0)) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("room_m", "speed", "time_s"), [(0.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (250.0, 0.0, 1.0),
                                    (350.0, 100.0, 1.0), (1200.0, 100.0, 2.0)],
)  # fmt: skip
def test_a_way_takes_so_long_at_least(room_m: float, speed: float, time_s: float) -> None:
    """100 m/s and 500 m/s²: 100 t + 250 t²."""
    assert free_s(room_m, speed, 500.0) == pytest.approx(time_s)


def test_a_signal_tells_who_watches_each_edge_when_it_is_known() -> None:
    signal = PlantSignal(False)
    calls: list[tuple[int, bool, int]] = []
    signal.watches.append(lambda at_ns: calls.append((at_ns, signal.level, len(signal.edges))))
    signal.add(5, True)
    signal.add(9, False)
    assert (calls, signal.edges) == ([(5, True, 1), (9, False, 2)], [(5, True), (9, False)])


# What an axis is given


def test_a_ramp_is_handed_over_in_si_units() -> None:
    fmu = Fmu(*RAMP)
    Ramp(fmu.roles).command(3 * MS, 0.25, -0.5, 4 * MS)
    assert fmu.written == [(0, dict(zip(RAMP, (0.25, -0.5, 0.003, 0.004), strict=True)))]


def test_a_demand_is_sampled_from_its_command_on_and_rests_at_its_end() -> None:
    """1 m/s from 0.5 m at 100 us on until 250 us; samples 62.5 us apart, whatever the steps are."""
    fmu = Fmu("demand")
    demand = SampledDemand(fmu.roles)
    fmu.time_ns = 100 * US
    demand.command(100 * US, 0.5, 1.0, 250 * US)
    assert [demand.at(us * US) for us in (100, 150, 250, 900)] == pytest.approx(
        [0.5, 0.50005, 0.50015, 0.50015]
    )
    demand.step(fmu.roles.slave, 200 * US)
    demand.step(fmu.roles.slave, 300 * US)
    assert fmu.steps == [162_500, 200_000, 225_000, 287_500, 300_000]
    samples_ns = [0, SAMPLE_NS, SAMPLE_NS, 2 * SAMPLE_NS, 3 * SAMPLE_NS]
    assert [values["demand"] for _, values in fmu.written] == pytest.approx(
        [0.5 + min(sample, 150_000) * 1e-9 for sample in samples_ns]
    )


def test_an_fmu_on_a_grid_gets_the_demand_at_the_begin_of_its_step() -> None:
    fmu = Fmu("demand", grid_ns=MS)
    demand = SampledDemand(fmu.roles)
    demand.command(0, 0.0, 1.0, 10 * MS)
    fmu.time_ns = 2 * MS
    demand.step(fmu.roles.slave, 3 * MS)
    assert (fmu.steps, fmu.written) == ([3 * MS], [(2 * MS, {"demand": pytest.approx(0.002)})])


def test_what_controls_an_axis_is_written_when_it_changes() -> None:
    fmu = Fmu(*RAMP, *GROUPS["control"])
    control = Control(fmu.roles)
    assert control.kinds == set(ControlKind)
    control.choose(ControlKind.POSITION)
    assert fmu.written == []
    control.choose(ControlKind.FORCE)
    control.choose(ControlKind.FORCE)
    control.give_force(12.5)
    control.choose(ControlKind.VELOCITY)
    control.give_slope(-3.0)
    assert [values for _, values in fmu.written] == [
        {"control": ControlKind.FORCE.value}, {"reference_force": 12.5},
        {"control": ControlKind.VELOCITY.value}, {"reference_acceleration": -3.0},
    ]  # fmt: skip
    assert control.kind is ControlKind.VELOCITY


@pytest.mark.parametrize(
    ("inputs", "kinds"),
    [((), {ControlKind.POSITION}), (GROUPS["control"], {ControlKind.POSITION}),
     (RAMP, {ControlKind.POSITION}), ((*RAMP, *GROUPS["control"]), set(ControlKind))],
)  # fmt: skip
def test_other_kinds_of_control_need_a_ramp(inputs: Sequence[str], kinds: set[ControlKind]) -> None:
    assert Control(Fmu(*inputs).roles).kinds == kinds


@pytest.mark.parametrize(
    ("inputs", "written"),
    [
        ((), None),
        (GROUPS["force_limit"], {"force_limit": 20.0}),
        (GROUPS["force_limits"], {"force_limit_negative": 30.0, "force_limit_positive": 20.0}),
        (
            GROUPS["force_limit"] + GROUPS["force_limits"],
            {"force_limit_negative": 30.0, "force_limit_positive": 20.0},
        ),
    ],
)
def test_one_limit_for_both_directions_is_the_tighter_one(
    inputs: Sequence[str], written: dict[str, float] | None
) -> None:
    fmu = Fmu(*inputs)
    control = Control(fmu.roles)
    control.limit(30.0, 20.0)
    assert control.limits_force is (written is not None)
    assert [values for _, values in fmu.written] == ([] if written is None else [written])


# An axis


def test_what_an_fmu_does_not_report_is_reckoned() -> None:
    """x = 1000 t²: its velocity is the slope of three points that are not too near.

    1.8 and 1.9 ms, off by 1 um, are: their errors would be speed.
    """

    def position_m(ns: int) -> float:
        return 1e-15 * ns * ns + (1e-6 if ns in (1800 * US, 1900 * US) else 0.0)

    fmu = Fmu("demand", position=position_m, force=5.0)
    axis = axis_of(fmu)
    assert (axis.motion, axis.tells_velocity) == ([0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0], False)
    axis.command(0, 0.0, 2.0, 1 * MS, True)
    for step in range(1, 21):
        axis.step_to(step * 100 * US)
    x, v = 0.004, 4.0
    assert axis.motion == pytest.approx([x, v, x, v, 0.002, 5.0, 0.0, 0.0], abs=1e-9)
    assert (axis.force_n(), axis.position_m()) == (5.0, x)


@pytest.mark.parametrize(
    ("outputs", "motor", "motor_v"),
    [
        ({}, 0.003, 3.0),
        ({"motor_position": lambda ns: 2e-9 * ns}, 0.002, 2.0),
        ({"motor_position": 0.5, "motor_velocity": 7.0}, 0.5, 7.0),
        ({"motor_velocity": 7.0}, 0.003, 7.0),
    ],
)
def test_a_motor_that_is_not_reported_moves_as_its_load(
    outputs: dict[str, Any], motor: float, motor_v: float
) -> None:
    fmu = Fmu("demand", position=lambda ns: 3e-9 * ns, velocity=3.0, **outputs)
    axis = axis_of(fmu)
    for step in range(1, 11):
        axis.step_to(step * 100 * US)
    assert (axis.motor_position_m(), axis.motor_velocity_m_s()) == pytest.approx((motor, motor_v))
    assert axis.tick == pytest.approx((0.0027, 3.0, 0.003, 3.0))
    assert axis.force_n() is None


def test_the_past_of_a_second_is_kept_and_found_to_the_instant() -> None:
    fmu = Fmu(*RAMP, position=lambda ns: 1e-9 * ns, velocity=1.0)
    axis = axis_of(fmu)
    for step in range(1, 1103):
        axis.step_to(step * MS)
    assert axis.motion_at(102 * MS)[0] == pytest.approx(0.102)
    assert axis.motor_position_m_at(500_250 * US) == pytest.approx(0.50025)
    (begin_ns, _), (end_ns, _) = axis.ends_around(500_250 * US)
    assert (begin_ns, end_ns) == (500 * MS, 501 * MS)
    begin, end = axis.ends_around(500 * MS)
    assert begin == end
    for wrong_ns in (1102 * MS - HISTORY_NS - 1, 1102 * MS + 1):
        with pytest.raises(PlantError, match="no motion is recorded"):
            axis.ends_around(wrong_ns)
    with pytest.raises(PlantError, match="no step ended"):
        axis.motion_at(500 * MS + 1)


def test_an_axis_goes_back_to_where_it_was_saved() -> None:
    fmu = Fmu(*RAMP, position=lambda ns: 1e-9 * ns, velocity=1.0)
    axis = axis_of(fmu)
    axis.step_to(1 * MS)
    axis.save()
    axis.step_to(2 * MS)
    axis.step_to(3 * MS)
    axis.restore()
    assert (axis.position_m(), fmu.time_ns) == (0.001, 1 * MS)
    with pytest.raises(PlantError):
        axis.motion_at(2 * MS)


@pytest.mark.parametrize("has_switch", [True, False])
def test_power_goes_to_the_fmu_when_it_changes_or_its_demand_stays(has_switch: bool) -> None:
    """Its motor is elsewhere than its load, as with an elastic coupling."""
    outputs = {"position": 0.3, "motor_position": 0.25, "demand_position": 0.125}
    fmu = Fmu("demand", *["enabled"] * has_switch, **outputs)
    axis = axis_of(fmu)
    axis.command(0, 0.5, 1.0, MS, False)
    first = [values["enabled"] for _, values in fmu.written]
    axis.command(0, 0.5, 1.0, MS, True)
    axis.command(0, 0.5, 1.0, MS, True)
    axis.command(MS, 0.75, 1.0, 2 * MS, False)
    demand = axis._samples
    assert demand is not None
    assert first == ([False] if has_switch else [])
    assert [values["enabled"] for _, values in fmu.written] == [False, True, False] * has_switch
    assert demand.at(2 * MS) == pytest.approx(0.751 if has_switch else 0.25)
    assert axis.demand_position_m() == 0.125


def test_without_a_position_to_follow_the_demand_is_the_actual_position() -> None:
    outputs = {"position": 0.3, "motor_position": 0.25, "demand_position": 0.125}
    fmu = Fmu(*RAMP, *GROUPS["control"], **outputs)
    axis = axis_of(fmu)
    assert axis.demand_position_m() == 0.125
    axis.command_force(0, 4.0)
    assert (axis.demand_position_m(), fmu.inputs["reference_force"]) == (0.25, 4.0)
    axis.command_velocity(5 * MS, 0.5, 2.0, 6 * MS)
    assert (axis.demand_position_m(), fmu.inputs["reference_acceleration"]) == (0.25, 2.0)
    assert [fmu.inputs[name] for name in RAMP] == [0.25, 0.5, 0.005, 0.006]
    axis.command(6 * MS, 0.0, 0.0, 7 * MS, True)
    assert axis.demand_position_m() == 0.125


@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
def test_a_number_that_is_none_is_refused_by_its_name(number: str) -> None:
    fmu = Fmu(*RAMP, position=lambda ns: float(number) if ns else 0.0, velocity=1.0)
    axis = axis_of(fmu)
    with pytest.raises(PlantError, match=rf"table\.position \(position\) is {number}$"):
        axis.step_to(MS)


def test_an_axis_that_nothing_switches_off_stays_where_it_was_then() -> None:
    """Without a switch the demand rests; a further order to be off does not move it."""
    fmu = Fmu("demand", position=0.3, motor_position=lambda ns: 0.25 + 1e-10 * ns)
    axis = axis_of(fmu)
    axis.command(0, 0.5, 1.0, MS, True)
    axis.step_to(2 * MS)
    axis.command(2 * MS, 0.5, 1.0, 3 * MS, False)
    demand = axis._samples
    assert demand is not None
    assert demand.at(2 * MS) == pytest.approx(0.2502)
    axis.step_to(4 * MS)
    axis.command(4 * MS, 0.75, 1.0, 5 * MS, False)
    assert demand.at(9 * MS) == pytest.approx(0.2502)


def test_between_the_points_of_its_grid_an_axis_moves_on_a_cubic() -> None:
    """x = t³ at points 4 ms apart, its force a straight line; a new demand waits for a point."""
    fmu = Fmu(
        "demand", grid_ns=4 * MS, position=lambda ns: (ns * 1e-9) ** 3,
        velocity=lambda ns: 3 * (ns * 1e-9) ** 2, force=lambda ns: ns * 1e-9,
    )  # fmt: skip
    axis = GridAxis(fmu.roles, lambda _ns: None)
    axis.start(0)
    axis.command(0, 0.0, 1.0, 100 * MS, True)
    for ms in (1, 3, 4, 5, 10):
        axis.step_to(ms * MS)
        t = ms * 1e-3
        assert axis.motion == pytest.approx([t**3, 3 * t**2, t**3, 3 * t**2, t, t, 0.0, 0.0])
    assert fmu.steps == [4 * MS, 8 * MS, 12 * MS]
    assert [values["demand"] for _, values in fmu.written] == pytest.approx([0.0, 0.004, 0.008])
    axis.save()
    axis.step_to(13 * MS)
    axis.restore()
    axis.step_to(11 * MS)
    assert axis.position_m() == pytest.approx(0.011**3)
    assert axis.tick == pytest.approx((0.01**3, 0.0003, 0.011**3, 0.000363))


# A distance sensor


@pytest.mark.parametrize(
    ("more", "reported"),
    [
        ({}, (0.5, None, True, False)),
        ({"distance_true": 0.75}, (0.5, 0.75, True, False)),
        ({"valid": 0.0}, (0.5, None, False, False)),
        ({"touching": 1.0}, (0.5, None, True, True)),
        ({"touching": 1.0, "valid": 0.0, "distance_true": 0.75}, (0.5, 0.75, False, True)),
    ],
)
def test_a_sensor_reports_what_its_fmu_knows(
    more: dict[str, float], reported: tuple[float, float | None, bool, bool]
) -> None:
    fmu = Fmu("z_position", distance=0.5, **more)
    moved: Any = SimpleNamespace(motion=[0.125, 0.0])
    sensor = PlantDistance(fmu.roles, {"z": moved})
    sensor.start(2 * MS)
    assert (fmu.inputs["z_position"], sensor.has_tool, sensor.walks) == (0.125, False, False)
    assert sensor.reported_at(2 * MS) == reported
    moved.motion = [0.25, 0.0]
    fmu.outputs["distance"] = 0.625
    sensor.step(2 * MS, 3 * MS)
    sensor.look()
    assert (fmu.inputs["z_position"], sensor.distance_m) == (0.25, 0.625)
    assert sensor.reported_at(3 * MS - 1) == reported
    assert sensor.reported_at(9 * MS) == (0.625, *reported[1:])
    with pytest.raises(PlantError, match="no distance is kept"):
        sensor.reported_at(2 * MS - 1)


@pytest.mark.parametrize(
    ("fine_us", "steps_us", "found_us"),
    [
        (50, (20, None), 40),
        (50, (None, 20), 40),
        (50, (50, 20), 50),  # a step as long as the span counts: 100 us is too long
        (50, (51, 20), 40),  # one that is longer does not
        (200, (20, 12.5), 200),
        (230, (20, 12.5), 200),  # lcm 100 us
        (70, (15, 10), 60),
        (50, (20, 15), 50),  # 60 us is too long for both
        (0.05, (0.0031, 0.02), 0.04),  # 3.1 ns: no whole nanosecond
        (50, (0.0, None), 50),
        (50, (), 50),
    ],
)
def test_the_fine_step_is_whole_internal_steps_of_every_axis(
    fine_us: float, steps_us: Sequence[float | None], found_us: float
) -> None:
    axes = [
        SimpleNamespace(
            slave=SimpleNamespace(
                can=SimpleNamespace(fixed_step_s=None if step is None else step * 1e-6)
            )
        )
        for step in steps_us
    ]
    plant: Any = SimpleNamespace(_axes=axes)
    assert Plant._whole_steps_ns(plant, round(fine_us * US)) == round(found_us * US)
