"""What metrics of 3D distance control find on rigs with an inclined tool; they see faults."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from axisrig.bench.judge.distance.control_findings import ControlFindings
from axisrig.bench.judge.distance.tool_metrics import TOOL_METRICS
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import findings, observe
from axisrig.bench.oracles.distance.tool import ECS, inclined_gain
from axisrig.bench.plan.checks import known_metrics, parse_check

AXES = ("X", "Y", "Z", "C", "A")
ROBOT_AXES = ("X", "Y", "Z", "A", "B", "C")
LEVER_MM = 180.0
DIST = "set:channel.dist_ctrl[0]."
QUICK = (f"{DIST}v_max=1000000", f"{DIST}a_max=1000000", f"{DIST}optimized_scheduling=1")
PLAIN = (*QUICK, f"{DIST}n_cycles=1")
LIFT = ("plant:gap.lift_mm=0.5", "plant:gap.lift_begin_ms=150.2", "plant:gap.lift_end_ms=150.2")
LOST = ("plant:gap.lost_begin_ms=100.5", "plant:gap.lost_end_ms=200")
ORTHOGONAL = '[plc]\n"V.E.SENSOR" = { sensor = "gap", period_ms = 1, normalise = "none" }\n'


def able(axes: tuple[str, ...] = AXES) -> list[str]:
    """Axes that no limit of their own holds."""
    names = {"dynamik.a_max": 10_000_000, "dynamik.vb_max": 50_000_000, "vb_eilgang": 50_000_000}
    return [f"set:{a}.getriebe[0].{name}={value}" for a in axes for name, value in names.items()]


def pose(c_deg: float, a_deg: float, lever_mm: float = LEVER_MM) -> list[str]:
    """Start positions with the tool centre point at 0."""
    c, a = math.radians(c_deg), math.radians(a_deg)
    x, y = lever_mm * math.sin(c) * math.sin(a), -lever_mm * math.cos(c) * math.sin(a)
    places = {"x": x, "y": y, "z": lever_mm * math.cos(a), "c": c_deg, "a": a_deg}
    return [f"plant:{name}.position_start_mm={value:.4f}" for name, value in places.items()]


def program(words: str, after: str = "G4 0.2") -> str:
    return (
        "V.G.WZ_AKT.L=80\n#TRAFO ON\nG1 X0 Y0 Z0 F60000\n"
        "#DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\n"
        f"#DIST CTRL ON [{words}]\n{after}"
    )


@dataclass(frozen=True)
class Judged:
    """A run and what metrics find of it."""

    observed: Observed

    def of(self, metric: str) -> Observation:
        words = known_metrics()[metric.partition(":")[0]].words
        condition = f"== {words.split()[0]}" if words else "!= 0"
        return observe(self.observed, parse_check(metric, condition, "here"))

    @property
    def alarms(self) -> list[int]:
        return [alarm.id for alarm in self.observed.facts.alarms if not alarm.is_further]

    def value(self, metric: str) -> Any:
        seen = self.of(metric)
        assert seen.value is not None, f"{metric}: {seen.note}"
        return seen.value


@pytest.fixture
def judged(run_nc: Callable[..., Any]) -> Callable[..., Judged]:
    def run(text: str, *assignments: str, rig: str = "", base: str = "distance-5axis.toml") -> Any:
        return Judged(run_nc(text, rig, *assignments, base=base).observed)

    return run


def sound(run: Judged) -> None:
    """What holds in every run: own model, own chains, kinematic of the plant."""
    assert run.value("offset_model_error_um") < 1e-3
    assert run.value("superposed_error_increments") < 1.0
    assert run.value("clamping_height_error_nm") < 1e-3
    assert run.value("kinematic_error_nm") < 1e-3
    assert run.value("tool_length_error_um") < 1e-6


@pytest.mark.long
def test_along_the_tool_after_it_has_tilted(judged: Any) -> None:
    """Deviation 1.5 mm, A -35, C 20: path 1.8312, shift 1.0503, X -0.3592, Y 0.9870 mm; the tool
    centre point stays while it tilts, but for half an increment of each axis and L d^2/8.
    """
    text = program("SET_POS=-1.5 MODE=ECS").replace(
        "#DIST CTRL [", "G1 A-35 F6000\n#DIST CTRL [", 1
    )
    run = judged(text, *pose(20.0, -33.0), *QUICK, *able())
    sound(run)
    assert run.value("tool_offset_path_mm") == pytest.approx(1.8312, abs=1e-4)
    assert run.value("tool_offset_sideways_mm") == pytest.approx(1.0503, abs=1e-4)
    assert run.value("tool_offset_x_mm") == pytest.approx(-0.3592, abs=1e-4)
    assert run.value("tool_offset_y_mm") == pytest.approx(0.9870, abs=1e-4)
    assert run.value("tool_offset_z_mm") == pytest.approx(1.5, abs=1e-4)
    assert run.value("tool_tilt_end_deg") == pytest.approx(35.0, abs=1e-4)
    assert run.value("tool_length_end_mm") == 80.0
    assert run.value("superposed_mm_max:Z") == pytest.approx(1.5, abs=0.2)
    # Half of 10 nm for X, Y, Z; 1e-4 deg of A, and of C with the lever L sin 35
    rounding_um = math.sqrt(3) * 5e-3 + 180e3 * math.radians(0.5e-4) * (
        1 + math.sin(math.radians(35))
    )
    assert run.value("tcp_error_um") <= run.value("tcp_error_expected_um") <= rounding_um
    between, most = run.value("tcp_error_between_um"), run.value("tcp_error_between_expected_um")
    assert between <= most
    assert most > run.value("tcp_error_expected_um")
    assert [one.axis for one in findings(run.observed).of(ControlFindings)] == ["channel"]


@pytest.mark.long
def test_along_the_normal_nothing_goes_sideways(judged: Any) -> None:
    text = program("CONST_DIST SET_DIST=80 MODE=MCS", "G4 0.2")
    run = judged(text, *pose(20.0, -35.0), *PLAIN, *LIFT, f"{DIST}kp=0.3", *able())
    sound(run)
    assert run.value("tool_sideways_um_max") < 1e-6
    assert run.value("tool_offset_path_mm") == pytest.approx(0.5, abs=1e-4)
    assert run.value("distance_dead_cycles") == run.value("distance_dead_cycles_expected") == 1
    assert run.value("distance_kp_limit") == pytest.approx(1.0, rel=1e-6)
    assert run.value("superposed_share_pct_min") == 100.0
    assert run.value("distance_behind_end_um") == pytest.approx(0.0, abs=0.2)


@pytest.mark.long
@pytest.mark.parametrize(
    ("words", "lag_cycles"),
    [("CONST_DIST SET_DIST=80", 10.0), ("SET_POS=0", 12.5)],
    ids=["const", "surface"],
)
@pytest.mark.parametrize("mode", ["ECS", "MCS"])
def test_the_error_on_a_ramp_is_along_the_normal(
    judged: Any, words: str, lag_cycles: float, mode: str
) -> None:
    """10 mm/s with kp 0.1: v T/kp; SET_POS n T + (N - 1)/2 T more, mean of 4, one dead cycle."""
    text = program(f"{words} MODE={mode}", "G4 0.4")
    ramp = ("plant:gap.lift_mm=2.5", "plant:gap.lift_begin_ms=100", "plant:gap.lift_end_ms=350")
    run = judged(text, *pose(20.0, -35.0), *QUICK, *ramp, f"{DIST}kp=0.1", *able())
    sound(run)
    assert run.value("distance_error_um") == pytest.approx(100.0, rel=0.01)
    assert run.value("distance_behind_um") == pytest.approx(10.0 * lag_cycles, rel=0.01)
    assert run.value("distance_behind_expected_um") == pytest.approx(10.0 * lag_cycles, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("words", "more", "alarm"),
    [
        ("CONST_DIST SET_DIST=80", LOST, 310018),
        ("SET_POS=-8", (), 310017),
        ("CONST_DIST SET_DIST=80", (f"{DIST}max_pos=650000",), 310019),
    ],
    ids=["jump", "offset", "above"],
)
def test_alarms_come_in_their_cycle(judged: Any, words: str, more: Any, alarm: int) -> None:
    run = judged(program(f"{words} MODE=ECS"), *pose(20.0, -35.0), *PLAIN, *more, *able())
    assert run.alarms == [alarm]
    assert run.value("distance_alarm_late_cycles") == 0.0


@pytest.mark.long
@pytest.mark.parametrize(
    "words",
    [
        "FILTER_TYPE=EXPO_MEAN SMOOTH_FACT=0.6",
        "FILTER_TYPE=KALMAN_MA N_CYCLES=8",
        "FILTER_TYPE=KALMAN_EXPO N_CYCLES=8",
        "FILTER_TYPE=LOWPASS",
        "FILTER_TYPE=MOVING_AVERAGE N_CYCLES=8",
    ],
)
@pytest.mark.parametrize("mode", ["ECS", "MCS", "ACS DIRECTION=Z"])
def test_every_mode_and_filter_tilting_frozen_and_turning_off(
    judged: Any, words: str, mode: str
) -> None:
    distance = 80 * math.cos(math.radians(35)) if mode.startswith("ACS") else 80
    after = (
        "#DIST CTRL [KP=0.05]\nG4 0.05\nG1 A-37 C21 X2 F60000\nG4 0.05\n"
        "#DIST CTRL FREEZE\nG1 A-34\n#DIST CTRL ON [CONST_DIST]\nG4 0.05\n#DIST CTRL WAIT OFF"
    )
    text = program(f"{words} KP=0.1 CONST_DIST SET_DIST={distance:.4f} MODE={mode}", after)
    wide = (f"{DIST}max_deviation=500000",)
    run = judged(text, *pose(20.0, -35.0), *QUICK, *LIFT, *wide, *able())
    sound(run)
    assert run.value("freeze_drift_um") == 0.0
    assert run.value("offset_end_mm") == 0.0


@pytest.mark.long
@pytest.mark.parametrize("mode", ["ECS", "MCS"])
def test_a_robot(judged: Any, mode: str) -> None:
    """The channel names its joints X Y Z A B C; the surface is at 720 mm."""
    text = (
        "V.G.WZ_AKT.L=80\n#TRAFO ON\n#DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\n"
        "G1 A10 B6 F6000\n#CS ON [0,0,720,0,0,0]\n"
        f"#DIST CTRL ON [SET_POS=0 MODE={mode}]\nG4 0.2\n#DIST CTRL FREEZE\nG1 A5\nG4 0.05"
    )
    lift = ("plant:gap.lift_mm=0.5", "plant:gap.lift_begin_ms=1", "plant:gap.lift_end_ms=1")
    run = judged(
        text, *QUICK, *lift, f"{DIST}kp=0.2", *able(ROBOT_AXES), base="distance-robot.toml"
    )
    sound(run)
    assert run.value("freeze_drift_um") == 0.0
    assert run.value("tcp_error_um") <= run.value("tcp_error_expected_um")
    # o = 0.5 mm along the normal, at 5 and 6 deg when it ends; 0.01 deg of six joints are rounding
    assert run.value("tool_offset_z_mm") == pytest.approx(0.5, abs=5e-3)
    if mode == "MCS":
        assert run.value("tool_offset_sideways_mm") < 5e-3
        assert run.value("tool_sideways_um_max") < 1e-3


@pytest.mark.long
@pytest.mark.parametrize(("tilt", "slope"), [(60.0, 10.0), (60.0, 30.0), (75.0, -10.0)])
@pytest.mark.parametrize(("share", "word"), [(0.98, "stable"), (1.02, "unstable")])
def test_stability_over_an_inclined_surface(
    judged: Any, tilt: float, slope: float, share: float, word: str
) -> None:
    """A sensor of the orthogonal distance; the limit of kp is divided by cos p + sin p tan b.

    Where that is above 2 (75/-10 deg: 2.97) the loop has two dead cycles: 1.835. kp is above 1
    then, and clamps leave the loop linear: no step of a slope is longer than the error.
    """
    gain = inclined_gain(ECS, tilt, slope)
    level = 1.0 if gain > 0.5 else 2 * math.sin(math.pi / 10)
    slow = () if gain > 0.5 else (f"{DIST}optimized_scheduling=0", "distance:limiter=clamp")
    text = program(f"CONST_DIST SET_DIST={80 * gain + 0.02:.6f} MODE=ECS", "G4 0.3")
    wide = (f"{DIST}max_deviation=500000", f"{DIST}kp={level / gain * share:.5f}")
    inclined = ("plant:gap.quantity=1", f"plant:gap.workpiece_tilt_x_deg={-slope}")
    plain = ("set:channel.kin_step[1].trafo[0].param[1]=900000", "plant:gap.extension.hd2_deg=90")
    run = judged(
        text, *pose(0.0, -tilt), *PLAIN, *slow, *wide, *inclined, *plain, *able(), rig=ORTHOGONAL
    )
    assert run.value("distance_kp_limit") == pytest.approx(level / gain, rel=1e-3)
    assert run.value("distance_stability") == word
    assert run.value("distance_growth") == pytest.approx(
        run.value("distance_growth_expected"), abs=3e-3
    )
    sound(run)


@pytest.mark.long
def test_what_the_axes_may_do_lowers_the_offset_without_an_alarm(judged: Any) -> None:
    """75 deg: Y goes tan 75 = 3.73 mm for 1 mm of offset, with 20 mm/s and 500 mm/s2."""
    text = program("SET_POS=-2 MODE=ECS", "G4 0.6\n#DIST CTRL WAIT OFF")
    slow = ("set:Y.getriebe[0].dynamik.a_max=500", "set:Y.getriebe[0].vb_eilgang=20000")
    limits = (f"{DIST}v_max=50000", f"{DIST}a_max=500")
    run = judged(text, *pose(0.0, -75.0), *PLAIN, *able(), *slow, *limits)
    sound(run)
    assert run.alarms == []
    rate = math.tan(math.radians(75))
    assert run.value("superposed_speed_mm_s_max:Y") <= 20.0 * (1 + 1e-6)
    assert run.value("superposed_acceleration_mm_s2_max:Y") <= 500.0 * (1 + 1e-4)
    assert run.value("superposed_share_pct_min") == pytest.approx(20 / rate / 50 * 100, rel=1e-4)


class Tampered(Observed):
    """A run with one column changed."""

    name, by = "", 0.0

    def column(self, axis: str, name: str, rows: slice | None = None) -> NDArray[np.float64]:
        values = super().column(axis, name, rows)
        return values + self.by if f"{axis}.{name}" == self.name else values


class Turning(Observed):
    """A run whose offset of 0.5 mm turns with A although its kinematic has gone."""

    def column(self, axis: str, name: str, rows: slice | None = None) -> NDArray[np.float64]:
        values = super().column(axis, name, rows)
        if f"{axis}.{name}" != "Y.superposed_mm":
            return values
        a_deg = super().column("A", "set_mm", rows)
        return np.where(a_deg > -39.9999, -0.5 * np.tan(np.radians(a_deg)), values)


@pytest.mark.long
def test_an_offset_whose_kinematic_has_gone_stays_and_one_that_turned_would_show(
    judged: Any,
) -> None:
    """FREEZE, #TRAFO OFF, A from -40 to -30 alone: Y by 0.5 (tan 40 - tan 30) = 0.13087 mm."""
    text = program(
        "SET_POS=-0.5 MODE=ECS",
        "G4 0.1\n#DIST CTRL FREEZE\n#TRAFO OFF\nG1 A-30 F60000\nG4 0.01",
    )
    run = judged(text, *pose(0.0, -40.0), *PLAIN, *able())
    sound(run)
    names = run.observed.series.names
    assert {"Z.superposed_mm", "A.superposed_deg"} <= set(names)
    assert "A.superposed_mm" not in names
    turning = Judged(Turning(run.observed.facts, run.observed.series))
    apart_mm = 0.5 * (math.tan(math.radians(40)) - math.tan(math.radians(30)))
    found = turning.value("superposed_error_increments:Y")
    assert found == pytest.approx(apart_mm * 1e5, abs=10)  # of 10 nm; the sensor has 0.1 um


@pytest.mark.parametrize(
    ("column", "by", "metric", "least"),
    [
        ("Y.superposed_mm", 3e-5, "superposed_error_increments", 2.0),
        ("Y.superposed_mm", 1e-3, "tool_sideways_um_max", 0.9),
        ("channel.surface_cnc_mm", 1e-6, "clamping_height_error_nm", 0.9),
        ("channel.tool_length_mm", 1e-3, "tool_length_error_um", 0.9),
        ("gap.tcp_x_mm", 1e-6, "kinematic_error_nm", 0.9),
    ],
)
@pytest.mark.long(but=1)
def test_a_fault_would_show(judged: Any, column: str, by: float, metric: str, least: float) -> None:
    run = judged(program("SET_POS=-1 MODE=MCS", "G4 0.05"), *pose(20.0, -35.0), *QUICK, *able())
    sound(run)
    wrong = Tampered(run.observed.facts, run.observed.series)
    wrong.name, wrong.by = column, by
    assert Judged(wrong).value(metric) > least


def test_every_metric_of_a_tool_is_in_the_table_and_says_why_it_has_no_value(judged: Any) -> None:
    run = judged("G4 0.02", base="probe-z.toml")
    for name in TOOL_METRICS:
        assert name in known_metrics()
        assert run.of(name).value is None
        assert run.of(name).note
