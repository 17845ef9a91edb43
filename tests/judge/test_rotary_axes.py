"""Lengths and forces of axes that turn: names, reasons, arms, and parameters of their FMU."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.judge.fixed_stop.findings import _turned
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.plant_values import PlantValues, power_of_arm
from axisrig.bench.judge.observed.rotary_metrics import in_newton_metres, turned
from axisrig.bench.judge.observed.topic import Topic
from axisrig.bench.judge.topics import TOPICS, observe
from axisrig.bench.plan.checks import known_metrics, parse_check
from axisrig.bench.record.axes import PlantRecord, PlantValue


def observed(axes: str, rotary: str = "", **arms_m: float) -> Any:
    """Each metric is about these axes; rotary: those that turn. arms_m: of torques."""
    return SimpleNamespace(
        about=lambda _metric, axis: [axis] if axis else [*axes],
        is_rotary=lambda axis: axis in rotary,
        torque_arm_m=arms_m.get,
    )


@pytest.mark.parametrize(
    ("metric", "seen", "words"),
    [
        ("overtravel_mm", observed("XZ"), ""),
        ("overtravel_mm", observed("C", "C"), "axis C turns: ask overtravel_deg"),
        ("latch_error_um", observed("C", "C"), "axis C turns: ask latch_error_mdeg"),
        ("overtravel_mm", observed("XC", "C"), "of axes X C only C turn: name one axis"),
        ("overtravel_mm:X", observed("XC", "C"), ""),
        ("overtravel_deg", observed("C", "C"), ""),
        ("overtravel_deg", observed("X"), "axis X is given in mm: ask overtravel_mm"),
        ("latch_error_mdeg", observed("XZ"), "axis X Z is given in um: ask latch_error_um"),
        ("overtravel_deg", observed("XC", "C"), "of axes X C only C turn: name one axis"),
        ("overtravel_deg:C", observed("XC", "C"), ""),
        # A force depends on what the plant is, not on the axis
        ("stop_force_n", observed("C", "C"), ""),
        ("stop_force_n", observed("C", C=0.1), "axis C turns: ask stop_torque_nm"),
        ("stop_torque_nm", observed("C", C=0.1), ""),
        ("stop_torque_nm", observed("C", "C"), "axis C is given in N: ask stop_force_n"),
        ("stop_force_n", observed("XC", C=0.1), "of axes X C only C turn: name one axis"),
        # Neither length nor force, and the tool of the run
        ("contact_to_detection_ms", observed("C", "C", C=0.1), ""),
        ("tcp_from_line_um_max", observed("XC", "C"), ""),
        ("set_jerk_mm_s3_max", observed("C", "C"), "axis C turns: ask set_jerk_deg_s3_max"),
    ],
)
def test_a_metric_of_an_axis_has_the_unit_of_its_motion(metric: str, seen: Any, words: str) -> None:
    assert turned(seen, parse_check(metric, "> -1e9", "")) == words


@pytest.mark.parametrize("arm_m", [0.25, 2.0])
def test_every_part_of_a_force_at_an_arm_is_turned(arm_m: float) -> None:
    """Four different numbers, so that none takes the place of another one."""
    run: Any = SimpleNamespace(torque_arm_m=lambda axis: arm_m if axis == "C" else None, rotary=())
    force = Value("force", "force", "N", "C", 100.0, 120.0, 90.0, 150.0, "why")
    found = _turned(run, force)
    assert (found.measured, found.expected, found.low, found.high) == (
        *(100.0 * arm_m, 120.0 * arm_m, 90.0 * arm_m, 150.0 * arm_m),
    )
    assert (found.unit, found.axis) == ("N.m", "C")
    assert _turned(run, replace(force, axis="X")) == replace(force, axis="X")
    open_ended = _turned(run, replace(force, expected=None, high=None))
    assert (open_ended.expected, open_ended.high, open_ended.low) == (None, None, 90.0 * arm_m)


@pytest.mark.parametrize("arm_m", [None, 0.25])
def test_of_an_axis_that_turns_lengths_are_angles_and_a_force_needs_an_arm(
    arm_m: float | None,
) -> None:
    run: Any = SimpleNamespace(torque_arm_m=lambda axis: arm_m if axis == "C" else None,
                               rotary=("C",))  # fmt: skip
    slide = "; as a slide with 1 mm for 1 degree"
    length, force = (
        Value("key", "label", unit, "C", 8.0, 4.0, 2.0, 6.0, "why") for unit in ("mm", "N")
    )
    assert _turned(run, length) == replace(length, unit="deg", note=f"why{slide}")
    torque = Value("key", "label", "N.m", "C", 2.0, 1.0, 0.5, 1.5, f"why{slide}")
    assert _turned(run, force) == (force if arm_m is None else torque)
    for other in (replace(length, axis="X"), replace(force, axis="X")):
        assert _turned(run, other) == other


def test_a_force_times_its_arm_is_a_torque() -> None:
    check = parse_check("stop_torque_nm", "> -1e9", "")
    found = in_newton_metres(Observation(200.0, 4.0, "why"), observed("CD", C=0.25, D=0.25), check)
    assert (found.value, found.uncertainty, found.note) == (50.0, 1.0, "why")
    other = in_newton_metres(Observation(200.0, 4.0), observed("CD", C=0.25, D=0.5), check)
    assert (other.value, other.note) == (
        None, "the axes have arms of different lengths: name one axis",
    )  # fmt: skip
    named = parse_check("stop_torque_nm:D", "> -1e9", "")
    found = in_newton_metres(Observation(200.0, 4.0), observed("CD", C=0.25, D=0.5), named)
    assert (found.value, found.uncertainty) == (100.0, 2.0)
    none = Observation(None, note="no stop was found")
    assert in_newton_metres(none, observed("CD", C=0.25, D=0.5), check) is none


ROTARY_TWINS = [name for name, metric in known_metrics().items() if metric.linear]


@pytest.mark.parametrize("name", ROTARY_TWINS)
def test_a_metric_of_a_rotary_axis_is_that_of_a_linear_one(name: str) -> None:
    """1 degree is 1 mm, a force times its arm is a torque."""
    metric = known_metrics()[name]
    assert any(metric.linear in topic.metrics for topic in TOPICS)

    def value(_observed: Any, axis: str | None) -> Observation:
        return Observation(8.0, 2.0, f"of {axis}")

    topics = [Topic("none", {}, lambda _observed: []),
              Topic("own", {metric.linear: value}, lambda _observed: [])]  # fmt: skip
    turns = observed("C", "C", C=0.25)
    turns.axes, turns.hides = {"C": None}, lambda _metric, _axis: ""
    turns.facts = SimpleNamespace(distance_3d=None)
    found = observe(turns, parse_check(f"{name}:C", "> -1e9", ""), topics)
    share = 0.25 if metric.unit == "N.m" else 1.0
    assert (found.value, found.uncertainty, found.note) == (8.0 * share, 2.0 * share, "of C")


# kg, m, s, A, K, mol, cd, rad
UNITS = {
    "N.m": ((1, 2, -2, 0, 0, 0, 0, 0), -1),
    "N.m/rad": ((1, 2, -2, 0, 0, 0, 0, -1), -2),
    "kg.m2": ((1, 2, 0, 0, 0, 0, 0, 0), -2),
    "N.m.s/rad": ((1, 2, -1, 0, 0, 0, 0, -1), -2),
    "rad": ((0, 0, 0, 0, 0, 0, 0, 1), 1),
    "rad/s": ((0, 0, -1, 0, 0, 0, 0, 1), 1),
    "1/s": ((0, 0, -1, 0, 0, 0, 0, 0), 0),
    "N": ((1, 1, -2, 0, 0, 0, 0, 0), 0),
}


@pytest.mark.parametrize("unit", UNITS)
def test_a_quantity_of_a_rotation_is_one_of_a_slide_by_the_arm(unit: str) -> None:
    """x = r phi, F = M/r, k = K/r^2, m = J/r^2, d = D/r^2; r = 0.5 m."""
    exponents, power = UNITS[unit]
    assert power_of_arm(exponents) == power
    plant = PlantRecord({"own": PlantValue(3.0, exponents), "plain": PlantValue(7.0)})  # type: ignore[arg-type]
    assert PlantValues(plant, 0.5).get("own") == pytest.approx(3.0 * 0.5**power)
    assert PlantValues(plant).get("own") == 3.0
    assert PlantValues(plant, 0.5).get("plain") == 7.0


def test_the_first_name_that_an_fmu_has_counts() -> None:
    plant = PlantRecord({"friction.coulomb": PlantValue(0.0), "coulomb_friction": PlantValue(9.0)})
    values = PlantValues(plant)
    assert values.get("missing", "friction.coulomb", "coulomb_friction") == 0.0
    assert values.number("friction.coulomb", otherwise=5.0) == 0.0
    assert (values.get("missing"), values.number("missing", otherwise=5.0)) == (None, 5.0)
    assert values.number("missing") == 0.0
