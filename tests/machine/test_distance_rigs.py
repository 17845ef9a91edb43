"""The rigs for distance control: what age the sensor value has, and what the trace keeps."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axisrig.bench.rig.distance.check import describe_distance
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings

Run = Callable[..., Any]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
APPROACH = "N10 G90 G01 Z31.5 F600"
COUNT_MM = 1e-5
"""Position unit of the drives in these rigs."""


def told_and_true(out: Any) -> tuple[np.ndarray, np.ndarray]:
    """The sensor value that the control had in each cycle, and the true one at its SYNC."""
    return -out.column("Z.sensor_mm"), out.column("gap.distance_true_mm")


@pytest.mark.parametrize(
    ("rig", "delay", "ages"),
    [
        ("distance-z", 0, [0, 0]),
        ("distance-z", 3, [3, 3]),
        ("distance-z", 10, [10, 10]),
        ("distance-z-2ms", 0, [0, 0]),
        ("distance-z-500k", 1, [1, 1]),
        ("distance-z-every-second", 0, [0, 1]),
        ("distance-z-every-second", 1, [1, 2]),
        ("distance-z-event", 0, [0, 0]),
        ("distance-xz-one-segment", 2, [2, 2]),
        ("distance-xz", 0, [0, 0]),
    ],
)
def test_the_sensor_value_has_the_age_that_the_telegrams_give_it(
    run_nc: Run, rig: str, delay: int, ages: list[int]
) -> None:
    """Whole cycles, from the truth of the plant; ages of even and odd cycles, in some order."""
    out = run_nc(APPROACH, "", f"drive:servo.second_delay_cycles={delay}", base=f"{rig}.toml")
    answer, true = told_and_true(out)
    assert out.alarms == []
    moving = np.flatnonzero(np.abs(np.diff(true)) > 1e-3)[12:-1] + 1  # past the begin
    found = [
        next(age for age in range(20) if abs(answer[k] - true[k - age]) < 0.51 * COUNT_MM)
        for k in moving
    ]
    assert sorted([set(found[0::2]), set(found[1::2])], key=min) == [{age} for age in ages]


@pytest.mark.long
@pytest.mark.parametrize("rig", ["distance-z", "distance-z-2ms", "distance-xz"])
def test_a_kinematic_axis_is_where_the_set_position_was_two_cycles_ago(
    run_nc: Run, rig: str
) -> None:
    out = run_nc(APPROACH, "", base=f"{rig}.toml")
    sent, received = out.column("Z.set_mm"), out.column("Z.actual_mm")
    begin = int(np.argmax(np.abs(np.diff(sent)) > 0))
    assert np.ptp(sent[begin:]) > 0.4
    assert np.max(np.abs(received[begin + 2 :] - sent[begin:-2])) <= 0.51 * COUNT_MM


@pytest.mark.long
def test_the_trace_keeps_the_distance_control(run_nc: Run) -> None:
    out = run_nc(
        "N10 G90 G01 Z31.5 F600\nN20 Z[DIST_CTRL ON SET_POS=30]\nN30 G04 0.3\nN40 Z[DIST_CTRL OFF]",
        "",
        "plant:gap.lift_mm=0.2",
        "plant:gap.lift_begin_ms=300",
        base="distance-z.toml",
    )
    assert out.alarms == []
    answer = {
        name: out.column(f"Z.{name}_mm")
        for name in ("sensor", "distance_cnc", "surface_cnc", "actual", "offset", "step", "set_pos")
    }
    known = ~np.isnan(answer["sensor"])
    assert known[10:].all()
    assert np.array_equal(answer["distance_cnc"][known], -answer["sensor"][known])
    surface = answer["actual"] + answer["sensor"]
    assert np.allclose(answer["surface_cnc"][known], surface[known], rtol=0, atol=1e-12)
    steps = np.diff(answer["offset"], prepend=0.0)
    assert np.allclose(answer["step"], steps, rtol=0, atol=1e-12)
    states = out.column("Z.distance_state")
    assert list(dict.fromkeys(states.tolist())) == [0, 1, 3]
    assert np.isnan(answer["set_pos"][0])
    assert set(answer["set_pos"][states == 1]) == {30.0}
    assert answer["offset"][states == 1][-1] == pytest.approx(0.2, rel=0, abs=COUNT_MM)


@pytest.mark.long
def test_a_workpiece_moves_and_a_signal_is_lost_in_time(run_nc: Run) -> None:
    """Two ramps, a sine, a loss: the true gap in closed form at every SYNC."""
    out = run_nc(
        "N10 G04 0.5",
        "",
        *("plant:gap.lift_mm=0.5", "plant:gap.lift_begin_ms=50", "plant:gap.lift_end_ms=90.4"),
        *("plant:gap.lift_2_mm=-0.7", "plant:gap.lift_2_begin_ms=120"),
        *("plant:gap.sway_um=30", "plant:gap.sway_frequency=13", "plant:gap.sway_begin_ms=200"),
        *("plant:gap.lost_begin_ms=400", "plant:gap.lost_end_ms=420"),
        base="distance-z.toml",
    )
    t = out.column("time_ns") * 1e-9
    surface = np.interp(t, [0.05, 0.0904], [30.0, 30.5]) - 0.7 * (t >= 0.12)
    surface += 0.03 * np.sin(2 * np.pi * 13 * np.clip(t - 0.2, 0.0, None))
    true = out.column("gap.distance_true_mm")
    assert np.max(np.abs(true - (32.0 - surface))) < 1e-9
    lost = (t >= 0.4) & (t < 0.42)
    assert np.array_equal(out.column("gap.valid"), ~lost)
    assert np.allclose(out.column("gap.distance_mm"), np.where(lost, 10.0, true), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("rig", "age"), [("distance-z-variable", 0), ("distance-z-variable-late", 2)]
)
def test_the_plc_side_shows_the_sensor_in_a_variable(run_nc: Run, rig: str, age: int) -> None:
    """In 0.1 um, counting against the motor, of the SYNC that the actual position is of."""
    choose = "N1 Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\nN2 G04 0.02\n"
    out = run_nc(choose + APPROACH, "", base=f"{rig}.toml")
    assert out.alarms == []
    answer, true = told_and_true(out)
    moving = np.flatnonzero(np.abs(np.diff(true)) > 1e-3)[4:] + 1
    assert np.array_equal(np.round(answer[moving] * 1e4), np.round(true[moving - age] * 1e4))
    assert np.ptp(answer[moving]) > 0.4


FAST = [
    f"set:Z.kenngr.distc.{name}=2000000000" for name in ("v_max", "a_max", "max_act_value_change")
]
BY_VARIABLE = "N1 Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]\n"


@pytest.mark.long(but=1)
@pytest.mark.parametrize("grows", [False, True])
@pytest.mark.parametrize(
    ("rig", "what", "place"),
    [
        ("distance-z", "CONST_DIST", 0),
        ("distance-z", "CONST_DIST with both encoders", 0),
        ("distance-z-every-second", "CONST_DIST", 0),
        ("distance-z-every-second", "CONST_DIST with both encoders", 0),
        ("distance-z-variable-late", "CONST_DIST", 1),
        ("distance-z-500k", "CONST_DIST", 0),
    ],
)
def test_the_limits_of_kp_that_the_check_reckons_are_those_of_the_machine(
    run_nc: Run, rig: str, what: str, place: int, grows: bool
) -> None:
    """A step of 20 um: 3 % below the limit the oscillation dies away, 3 % above it grows."""
    settings = read_settings(*read_rig(RIGS / f"{rig}.toml"), [])
    text = describe_distance(settings, {})[place]
    limit = float(re.findall(rf"below kp ([\d.]+) +{what}:", text)[0])
    both = " BOTH_ENCODER=1" if "both" in what else ""
    on = f"N20 Z[DIST_CTRL ON CONST_DIST SET_DIST=2{both}]\nN30 G04 0.5\nN40 Z[DIST_CTRL FREEZE]"
    kp = limit * (1.03 if grows else 0.97)
    out = run_nc(
        (BY_VARIABLE if place else "") + on,
        "",
        *FAST,
        f"set:Z.kenngr.distc.kp={kp:.6f}",
        *("plant:gap.lift_um=20", "plant:gap.lift_begin_ms=100"),
        base=f"{rig}.toml",
    )
    error, ms = np.abs(out.column("Z.error_mm")), out.column("time_ns") * 1e-6
    early, late = error[(ms > 200) & (ms < 300)].max(), error[(ms > 400) & (ms < 500)].max()
    assert out.alarms == [70332]  # still on at the end: frozen
    assert late > 1.5 * early if grows else late < early / 1.5
