"""The path of a run to a fixed stop: from where it counts, and what it has in the ramp.

Z as in `stop_recordings.py`: 10 mm/s from 20 ms on, and a block of 5 mm.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEMAND,
    DETECT,
    FIRST,
    K_N_M,
    LOAD,
    MASS_KG,
    PRESSED_N,
    RUN,
    SPEED,
    STOP,
    STOP_MM,
    K,
    recorded,
)
from tests.recordings import kept

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.run import StopRun, stop_runs
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord, PlantRecord, PlantValue
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.kernel.time.clock import MS

SLOPE = "getriebe[0].lslope_profil."


def run_of(observed: Observed) -> StopRun:
    (run,) = stop_runs(observed)
    return run


# Where it begins


def after_a_way(before_mm: float, side: float, written: Mapping[str, Any]) -> Observed:
    """Until 8 ms the axis comes from elsewhere; the run begins at 10 ms."""
    away = np.where(K < 8, -before_mm * (8 - K) / 8.0, 0.0)
    columns = {
        name: side * (values + away)
        for name, values in (("set_mm", DEMAND), ("actual_mm", LOAD), ("truth_mm", LOAD))
    }
    return recorded(side, written=written, columns=columns)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("before_mm", [0.0, 3.0, -3.0])
@pytest.mark.parametrize(
    ("written", "arming_mm"),
    [
        ({DETECT + "start_distance": 5000}, 0.5),
        ({DETECT + "start_distance_per_mille": 200}, 1.0),
        ({DETECT + "start_distance": 5000, DETECT + "start_distance_per_mille": 200}, 0.5),
        ({DETECT + "start_distance": 15_000, DETECT + "start_distance_per_mille": 200}, 1.0),
    ],
)
def test_a_path_counts_from_the_begin_of_its_run(
    written: Mapping[str, Any], arming_mm: float, before_mm: float, side: float
) -> None:
    """The interpolation is one cycle ahead of the demand, and judged a cycle later."""
    run = run_of(after_a_way(before_mm, side, written))
    assert run.block_mm == pytest.approx(5.0)
    assert run.arming_mm == pytest.approx(arming_mm)
    assert run.path_mm[[10, FIRST, 120, 399]] == pytest.approx([0.0, 0.0, 1.0, 2.0])
    assert run.armed_ns == pytest.approx((FIRST + arming_mm * 100 - 1) * MS, abs=5)
    contact = run.contact("Z")
    assert contact is not None
    assert contact.time_ns == pytest.approx(CONTACT_MS * MS, abs=5)


@pytest.mark.parametrize(
    ("way_mm", "at_mm"), [(1.99, 1.99), (2.0, 2.0), (2.0008, 2.0008), (2.002, None), (9.0, None)]
)
def test_a_path_is_gone_where_it_ends_to_an_increment(way_mm: float, at_mm: float | None) -> None:
    """The demand goes 2 mm in all, with increments of 0.001 mm; 10 um a cycle until 220 ms."""
    run = run_of(recorded(written={DETECT + "start_distance": round(way_mm * 10_000)}))
    assert run.arming_mm == pytest.approx(way_mm)
    if at_mm is None:
        assert run.armed_ns is None
    else:
        assert run.armed_ns == pytest.approx((FIRST + at_mm * 100 - 1) * MS, abs=0.1 * MS)


# How a contact shows


def test_a_contact_is_as_sure_as_the_surer_way_to_find_it() -> None:
    """An acceleration of a = 5000 mm/s2 before it: the free motion is in doubt by what it may do.

    g = 3 um at v = 10 mm/s: 2 g/(v + sqrt(v^2 - 2 a g)) less 0.3 ms. The bend of the stop leaves
    J h^3/192 with J = 2 k v/m, so 2 (k/m) h^3/192 of a step of 1 ms.
    """
    speed = SPEED.copy()
    speed[138] += 5.0
    by_free_us = 1e3 * (0.006 / (10.0 + (100.0 - 30.0) ** 0.5) * 1e3 - 0.3)
    by_bend_us = 2.0 * (K_N_M / MASS_KG) * 1e-9 / 192.0 * 1e6
    assert by_bend_us < by_free_us
    for plant, doubt_us in (
        ({}, by_bend_us),
        ({"effective_mass": 4 * MASS_KG}, by_bend_us / 4.0),
        ({"effective_mass": None}, by_free_us),
        ({"stop_stiffness": None}, by_free_us),
    ):
        contact = run_of(recorded(plant=plant, columns={"velocity_mm_s": speed})).contact("Z")
        assert contact is not None
        assert contact.uncertainty_ns == pytest.approx(1e3 * doubt_us + 1.0, rel=1e-6)
        assert contact.time_ns == pytest.approx(CONTACT_MS * MS, abs=5)


@pytest.mark.parametrize(("row", "first"), [(100, 99), (12, 11), (300, 140), (10, 140)])
def test_a_contact_between_two_rows_shows_by_its_force_alone(row: int, first: int) -> None:
    """A force since the row before; that of the first row of the run was before it."""
    peak = np.where(row == K, 40.0, 0.0) + PRESSED_N
    contact = run_of(recorded(columns={"stop_force_peak_n": peak})).contact("Z")
    without = run_of(recorded(columns={"stop_force_peak_n": None})).contact("Z")
    assert contact is not None
    assert without is not None
    assert (contact.row, without.row) == (first, 140)


@pytest.mark.parametrize(("beside_mm", "is_lost"), [(0.0, False), (1e-6, False), (-1e-6, True)])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_axis_that_rests_at_its_stop_touches_it(
    beside_mm: float, is_lost: bool, side: float
) -> None:
    """Without a force, from row 150 to 259; found at 280.6 ms."""
    load = LOAD.copy()
    load[150:260] = STOP_MM + beside_mm
    force = np.maximum(load - STOP_MM, 0.0) * 1e-3 * K_N_M
    columns = {
        "actual_mm": side * load, "truth_mm": side * load, "stop_force_n": force,
        "stop_force_peak_n": None, "drive_lag_mm": side * (DEMAND - load),
        "stop_mm": np.full(len(K), side * STOP_MM),
    }  # fmt: skip
    late = replace(RUN, fixed_stop=replace(STOP, detected_ns=280 * MS + 600_000))
    lasting = run_of(recorded(side, run=late, columns=columns)).lasting("Z")
    assert lasting is not None
    assert (lasting.lost_ns > 0) is is_lost
    assert lasting.contact is not None
    assert lasting.contact.row == (259 if is_lost else 140)


# What counts in the ramp


@pytest.mark.parametrize(
    ("channel", "ramp"),
    [
        ({}, "a_grenz_stufe_1"),
        # The feed blocks count with P-CHAN-00296 (FCT-C4 2.1)
        ({"meas_use_std_dynamic": 1}, "a_stufe_1"),
    ],
)
@pytest.mark.parametrize("slow", [True, False])
def test_a_window_holds_in_the_ramp_up_and_not_in_the_one_down(
    channel: Mapping[str, Any], ramp: str, slow: bool
) -> None:
    """W = 0.16 mm in 20 ms. With a = 100 mm/s2 s_min = (a/2) (W/(a tau) + tau/2)^2 = 0.405 mm.

    With 1000 mm/s2 it is W itself; the run counts from 0.3 mm on.
    """
    others = ("a_grenz_stufe_1", "d_grenz_stufe_1", "a_stufe_1", "a_feedh")
    written = {
        DETECT + "pos_lag_limit": 0,
        DETECT + "max_delta_position_window": 1600,
        DETECT + "start_distance": 3000,
        **{SLOPE + name: 1000.0 if slow else 100.0 for name in others},
        SLOPE + ramp: 100.0 if slow else 1000.0,
    }
    of = recorded(written=written)
    of = Observed(replace(of.facts, channel=dict(channel)), of.series)
    (block,) = stop_findings(of)
    words = (
        "found in free motion: Z: the window counts from 0.3 mm on, but in the ramp it holds up to"
        " 0.405 mm"
    )
    assert (block.prediction == words) is slow
    assert block.prediction == words or "found by window" in block.prediction


# Under a kinematic


HEAD = ("X", "Y", "Z", "C", "A")


def under_a_head(zeros: Mapping[str, float]) -> Observed:
    """Z goes to its stop as the third axis of a head whose tool, 80 mm long, points down.

    zeros: where homing has put the zero of each axis.
    """
    observed = recorded(
        plant={"stop_position": (STOP_MM + zeros.get("Z", 0.0)) * 1e-3},
        columns={"truth_mm": LOAD + zeros.get("Z", 0.0)},
    )
    table = observed.series.table()
    columns = {name: table[name] for name in table.column_names}
    axes, still = {}, np.zeros(len(K))
    for node, name in enumerate(HEAD, 1):
        homed = {"origin_mm": zeros.get(name, 0.0), "homed_ns": (5 * MS,)}
        if name == "Z":
            axes[name] = replace(observed.axes["Z"], **homed)
            continue
        axes[name] = AxisRecord(
            "can1", node, 1000.0, plant=name.lower(), is_rotary=name in "CA", **homed
        )
        for signal in ("set_mm", "actual_mm", "velocity_mm_s", "drive_lag_mm", "cnc_lag_mm"):
            columns[f"{name}.{signal}"] = still
        columns[f"{name}.truth_mm"] = still + zeros.get(name, 0.0)
    run = replace(RUN, fixed_stop=replace(STOP, axes=HEAD), target_mm={"Z": -75.0})
    plants = {name.lower(): PlantRecord({"kv": PlantValue(50.0)}) for name in HEAD if name != "Z"}
    facts = replace(
        observed.facts, axes=axes, runs=(run,), plants={**observed.facts.plants, **plants},
        kinematics=(KinematicRecord(0, None, HEAD, (9,), 80.0),),
    )  # fmt: skip
    return Observed(facts, kept(pa.table(columns)))


@pytest.mark.parametrize(
    "zeros",
    [{}, {"Z": 7.5}, {"X": 100.0, "Y": -20.0}, {"A": 30.0}, {"C": 50.0, "A": -40.0, "Z": -3.0}],
)
def test_a_path_of_the_tool_is_in_positions_of_the_machine(zeros: Mapping[str, float]) -> None:
    """From -80 to -75 mm of the tool, wherever the drives count from."""
    run = run_of(under_a_head(zeros))
    assert set(run.truths) == set(HEAD)
    assert run.block_mm == pytest.approx(5.0)
    assert run.path_mm[[20, 120, 399]] == pytest.approx([0.0, 1.0, 2.0])
