"""Metrics of recordings with several axes, buses and probes that differ, in every direction."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest
from tests.recordings import facts

from axisrig.bench.judge.distance.orders import set_by_program
from axisrig.bench.judge.fixed_stop.metrics import _standing_rows
from axisrig.bench.judge.fixed_stop.truth import axis_truth
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import (
    AxisRecord,
    Contact,
    Deflection,
    Edge,
    PlantRecord,
    PlantValue,
    ProbeRecord,
    TorqueLimit,
)
from axisrig.bench.record.bus import BusFigures, Waiting
from axisrig.bench.record.distance import DistanceOrder, DistanceRecord
from axisrig.bench.record.facts import MessageRecord, Timing
from axisrig.bench.record.measuring import MeasurementRun, PlcTaskRecord
from axisrig.bench.record.series import Series, SeriesWriter, column_of
from axisrig.kernel.time.clock import MS

ROWS = 40
TIMES = np.arange(ROWS, dtype=np.int64) * MS


def seen(observed: Observed, metric: str) -> Observation:
    return observe(observed, parse_check(metric, "> -1e9", ""))


def at_rest(**columns: Any) -> Series:
    return Series(pa.table({"time_ns": TIMES, **columns}))


# Buses


def _bus(segment: str, *loads_pct: float, errors: int, **waits_us: float) -> BusFigures:
    waiting = tuple(Waiting(f"{axis}.TPDO1", axis, 0x181, us) for axis, us in waits_us.items())
    return BusFigures(segment, 1_000_000, *loads_pct, 10, errors, "", (), waiting)


@pytest.mark.parametrize("turn", [1, -1])
def test_of_several_buses_the_one_with_most_counts_and_errors_add_up(turn: int) -> None:
    """One has the most over all and in 1 ms, the other in 100 ms; their order says nothing."""
    buses = (_bus("a", 30, 40, 90, errors=2, X=7), _bus("b", 20, 60, 80, errors=3, Y=5, Z=9))
    axes = {name: AxisRecord("a", 1, 1.0) for name in "XYZ"}
    observed = Observed(facts(axes=axes, buses=buses[::turn]), at_rest())
    found = {
        name: seen(observed, name).value
        for name in ("bus_load_pct", "bus_load_100ms_pct_max", "bus_load_1ms_pct_max")
    }
    assert list(found.values()) == [30, 60, 90]
    assert seen(observed, "error_frames").value == 5
    waits = [seen(observed, f"queueing_us_max{of}") for of in ("", ":X", ":Y", ":Z")]
    assert [(wait.value, wait.note) for wait in waits] == [
        *((9, "Z.TPDO1"), (7, "X.TPDO1"), (5, "Y.TPDO1"), (9, "Z.TPDO1")),
    ]


# Set positions


def _in_blocks(set_mm: npt.NDArray[np.float64], sizes: Sequence[int], path: Path) -> Series:
    writer, begin = SeriesWriter(path), 0
    for size in sizes:
        own = slice(begin, begin + size)
        writer.add({"time_ns": column_of(TIMES[own]), "Z.set_mm": column_of(set_mm[own])})
        begin += size
    return writer.close()


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("first", [18, 19, 20, 21, 22, 23])
def test_an_acceleration_counts_wherever_a_block_of_the_trace_ends(
    tmp_path: Path, first: int, sign: int
) -> None:
    """0.1 mm more a cycle in one cycle and 0.05 less in a later one: 1e5 and 5e4 mm/s2.

    The jerk is that of the first one, 1e8 mm/s3. A cycle in three blocks has all of it.
    """
    steps = np.zeros(ROWS)
    steps[20:] += 0.1 * sign
    steps[30:] -= 0.05 * sign
    axes = {"Z": AxisRecord("can1", 1, 1000.0)}
    series = _in_blocks(np.cumsum(steps), (first, 1, ROWS - first - 1), tmp_path / "a.parquet")
    observed = Observed(facts(axes=axes, end_ns=int(TIMES[-1])), series)
    assert len(series.blocks) == 3
    assert seen(observed, "set_acceleration_mm_s2_max").value == pytest.approx(1e5)
    assert seen(observed, "set_deceleration_mm_s2_max").value == pytest.approx(5e4)
    assert seen(observed, "set_jerk_mm_s3_max").value == pytest.approx(1e8)


@pytest.mark.parametrize("turn", [1, -1])
def test_of_several_axes_the_largest_counts_and_each_has_its_own(turn: int) -> None:
    """X brakes with 2e5 mm/s2, Z speeds up with 1e5, whichever of them the rig names first."""
    one, other = np.zeros(ROWS), np.zeros(ROWS)
    one[:25], other[10:] = 0.2, -0.1
    named = {"X": np.cumsum(one), "Z": np.cumsum(other)}
    axes = {name: AxisRecord("can1", 1, 1000.0) for name in list(named)[::turn]}
    series = at_rest(**{f"{name}.set_mm": values for name, values in named.items()})
    observed = Observed(facts(axes=axes, end_ns=int(TIMES[-1])), series)
    kinds = ("acceleration", "deceleration")
    found = {
        of: [seen(observed, f"set_{kind}_mm_s2_max{of}").value for kind in kinds]
        for of in ("", ":X", ":Z")
    }
    assert found[""] == pytest.approx([1e5, 2e5])
    assert found[":X"] == pytest.approx([0.0, 2e5], abs=1e-6)
    assert found[":Z"] == pytest.approx([1e5, 0.0], abs=1e-6)


# Touches


def _touched(**of_axis: Any) -> Observed:
    """Z goes down with 10 mm/s and touches at 99.9 mm; its published value is 0.5 um off."""
    place_mm = 100.0 - 10.0 * TIMES * 1e-9
    contact = Contact(10 * MS, {"z": 99.9})
    run = MeasurementRun(
        ("Z",), inputs={"Z": 1}, sources={"Z": "DRIVE"}, signal_ns=11 * MS, end_ns=30 * MS,
        latched_mm={"Z": 99.9005},
    )  # fmt: skip
    axis = AxisRecord("can1", 1, 1000.0, plant="z", signals={"probe_1": "probe"}, **of_axis)
    found = facts(
        end_ns=39 * MS,
        axes={"Z": axis},
        plants={"z": PlantRecord()},
        probes={"probe": ProbeRecord(True, 1.0, (contact,), (Edge(10 * MS, True),))},
        runs=(run,),
    )
    series = at_rest(
        **{"Z.truth_mm": place_mm, "Z.velocity_mm_s": np.full(ROWS, -10.0)},
    )
    return Observed(found, series)


def test_a_latch_that_nothing_proves_is_known_as_far_as_it_is_believed() -> None:
    """Of the value in mm, of its error in um: 0.25 mm are 250 um."""
    proved, doubted = _touched(), _touched(doubt_mm=0.25, unproved_latches=1)
    for metric, doubt in (("latch_mm:Z", 0.25), ("latch_error_um:Z", 250.0)):
        one, other = seen(proved, metric), seen(doubted, metric)
        assert one.value == other.value
        assert other.uncertainty - one.uncertainty == pytest.approx(doubt)
        assert "unproved" in other.note
        assert "unproved" not in one.note
    assert seen(proved, "latch_error_um:Z").value == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(
    ("of_run", "doubt_mm"), [(None, 0.25), ({}, 0.0), ({"Z": 0.125}, 0.125), ({"X": 0.125}, 0.0)]
)
def test_a_latch_of_a_run_has_the_doubt_of_this_run(
    of_run: dict[str, float] | None, doubt_mm: float
) -> None:
    """Nothing proved another latch of the axis, to 0.25 mm; a recording without doubts of its runs
    has no more than that.
    """
    observed = _touched(doubt_mm=0.25, unproved_latches=1)
    (run,) = observed.facts.runs
    observed = Observed(
        replace(observed.facts, runs=(replace(run, doubt_mm=of_run),)), observed.series
    )
    found, proved = seen(observed, "latch_mm:Z"), seen(_touched(), "latch_mm:Z")
    assert found.uncertainty - proved.uncertainty == pytest.approx(doubt_mm)
    assert ("unproved" in found.note) is bool(doubt_mm)


def test_a_number_printed_by_a_program_says_whose_latches_nothing_proves() -> None:
    axes = {
        "X": AxisRecord("can1", 1, 1.0),
        "Y": AxisRecord("can1", 2, 1.0, unproved_latches=2),
        "Z": AxisRecord("can1", 3, 1.0, unproved_latches=1),
    }
    messages = (MessageRecord(30, (1.0,), ""), MessageRecord(None, (8.0,), ""),
                MessageRecord(40, (2.0, 3.0), ""), MessageRecord(30, (4.0,), ""))  # fmt: skip
    observed = Observed(facts(axes=axes, messages=messages), at_rest())
    found = [seen(observed, f"msg:{of}") for of in ("N30", "N40", "N40.2", "N30.2")]
    assert [one.value for one in found] == [1.0, 2.0, 3.0, 4.0]
    assert all(one.note.endswith("latches of Y Z") for one in found)
    assert "printed 2 number(s)" in seen(observed, "msg:N40.3").note


@pytest.mark.parametrize(
    ("block", "values"),
    [("N3", [1.0, 4.0]), ("N30", [2.0]), ("N300", [3.0]), ("N0", []), ("N33", [])],
)
def test_a_printed_number_is_of_the_whole_number_of_its_block(
    block: str, values: list[float]
) -> None:
    messages = [
        *(MessageRecord(3, (1.0,), ""), MessageRecord(30, (2.0,), "")),
        *(MessageRecord(None, (9.0,), ""), MessageRecord(300, (3.0,), "")),
        MessageRecord(3, (4.0,), ""),
    ]
    observed = Observed(facts(axes={}, messages=tuple(messages)), at_rest())
    for place, value in enumerate([*values, None], start=1):
        found = seen(observed, f"msg:{block}.{place}")
        assert found.value == value
        missing = f"block {block} printed {len(values)} number(s)"
        assert found.note == ("" if value is not None else missing)


@pytest.mark.parametrize("turn", [1, -1])
def test_the_largest_deflection_is_looked_for_at_drives_and_at_the_plc(turn: int) -> None:
    """Two probes at drives, one at the PLC, one that nothing is wired to."""
    sizes_mm = {"first": (0.1, 0.4), "second": (0.3,), "of_plc": (0.2, 0.7), "loose": (9.0,)}
    probes = {
        name: ProbeRecord(True, 1.0, deflections=tuple(Deflection(mm, mm / 100) for mm in sizes))
        for name, sizes in list(sizes_mm.items())[::turn]
    }
    axes = {
        "X": AxisRecord("can1", 1, 1.0, signals={"probe_1": "first"}),
        "Z": AxisRecord("can1", 2, 1.0, signals={"probe_2": "second"}),
    }
    task = PlcTaskRecord(MS, 0, 0, MS, 0, probes=("of_plc",))
    alone = Observed(facts(axes=axes, probes=probes), at_rest())
    beside = Observed(facts(axes=axes, probes=probes, plc_task=task), at_rest())
    metric = "probe_deflection_mm_max"
    found = [seen(alone, f"{metric}{of}") for of in ("", ":X", ":Z")]
    assert [one.value for one in found] == [0.4, 0.4, 0.3]
    assert [one.uncertainty for one in found] == pytest.approx([0.004, 0.004, 0.003])
    assert [seen(beside, f"{metric}{of}").value for of in ("", ":X")] == [0.7, 0.7]
    small = Observed(
        facts(axes=axes, probes=probes, plc_task=PlcTaskRecord(MS, 0, 0, MS, 0)), at_rest()
    )
    assert seen(small, metric).value == 0.4


# Fixed stops


@pytest.mark.parametrize(("direction", "per_mille"), [(1, 300), (-1, 500)])
def test_the_torque_limit_is_that_of_the_direction_and_of_the_instant(
    direction: int, per_mille: int
) -> None:
    """60E0 acts upwards, 60E1 downwards, 6072 in both; F = 2 pi M/lead, the motor has no limit."""
    limits = (
        TorqueLimit(0, 3000, 2000, 2500),
        TorqueLimit(10 * MS, 1000, 500, 300),
        TorqueLimit(20 * MS, 200, 500, 300),
    )
    values = {
        "stop_direction": direction, "stop_position": 0.1, "stop_stiffness": 1e7,
        "effective_mass": 100.0,
    }  # fmt: skip
    axis = AxisRecord(
        *("can1", 1, 1000.0),
        plant="z",
        rated_torque_mnm=1000,
        lead_um=10_000.0,
        torque_limits=limits,
    )
    plant = PlantRecord({name: PlantValue(value) for name, value in values.items()})
    names = ("actual_mm", "truth_mm", "velocity_mm_s", "drive_lag_mm", "set_mm", "cnc_lag_mm")
    series = at_rest(**{f"Z.{name}": np.zeros(ROWS) for name in names})
    truth = axis_truth(Observed(facts(axes={"Z": axis}, plants={"z": plant}), series), "Z", 0.0)
    found = [truth.pressing(at_ns) for at_ns in (5 * MS, 10 * MS, 19 * MS, 30 * MS)]
    at_first = 2500 if direction > 0 else 2000
    assert [pressing and pressing.limit_n for pressing in found] == pytest.approx(
        [2 * math.pi * 100 * each / 1000 for each in (at_first, per_mille, per_mille, 200)]
    )


@pytest.mark.parametrize("zero_mm", [0.0, 12.5])
@pytest.mark.parametrize("rows", [5, 1])
@pytest.mark.parametrize(("late", "fresh"), [(0, 0), (1, 0), (3, 1), (4, 0), (6, 0)])
def test_the_encoder_of_a_drive_is_that_of_its_sync_and_stays_where_the_record_ends(
    late: int, fresh: int, rows: int, zero_mm: float
) -> None:
    """6064 comes late less fresh cycles later: what did not come any more is the last that did.

    The demand is by the lag of the drive ahead of it; a control reads the encoder as it came.
    """
    came_mm, lag_mm = np.array([1.0, 4.0, 9.0, 16.0, 25.0])[:rows], np.full(rows, 0.125)
    names = ("truth_mm", "velocity_mm_s", "set_mm", "cnc_lag_mm")
    columns = {f"Z.{name}": np.zeros(rows) for name in names}
    columns |= {"Z.actual_mm": came_mm, "Z.drive_lag_mm": lag_mm}
    table = pa.table({"time_ns": TIMES[:rows], **columns})
    axis = AxisRecord("can1", 1, 1000.0, plant="z", late_cycles=late, fresh_late_cycles=fresh)
    observed = Observed(facts(axes={"Z": axis}, plants={"z": PlantRecord({})}), Series(table))
    course = axis_truth(observed, "Z", zero_mm).course
    later = late - fresh
    encoder_mm = [came_mm[min(row + later, rows - 1)] + zero_mm for row in range(rows)]
    assert course.encoder_mm.tolist() == encoder_mm
    assert course.demand_mm.tolist() == [place + 0.125 for place in encoder_mm]
    read = course.read(later)
    assert read.encoder_mm[later:].tolist() == (came_mm + zero_mm)[later:].tolist()
    assert read.demand_mm.tolist() == course.demand_mm.tolist()


@pytest.mark.parametrize("weight_n", [0.0, 20.0, -7.0])
@pytest.mark.parametrize("place_m", [0.1, -0.05])
def test_weight_and_imbalance_pull_together_where_the_stop_is(
    place_m: float, weight_n: float
) -> None:
    """M_u sin phi of an axis that turns, with phi = x/r; a slide has no imbalance."""
    values = {"stop_position": place_m, "imbalance": 50.0, "weight": weight_n,
              "effective_mass": 100.0}  # fmt: skip
    plant = PlantRecord({name: PlantValue(value) for name, value in values.items()})
    names = ("actual_mm", "truth_mm", "velocity_mm_s", "drive_lag_mm", "set_mm", "cnc_lag_mm")
    series = at_rest(**{f"Z.{name}": np.zeros(ROWS) for name in names})
    for arm_m, pull_n in ((None, 0.0), (0.2, 50.0 * math.sin(place_m / 0.2))):
        axis = AxisRecord("can1", 1, 1000.0, plant="z", arm_m=arm_m)
        truth = axis_truth(Observed(facts(axes={"Z": axis}, plants={"z": plant}), series), "Z", 0.0)
        assert truth.axis is not None
        assert truth.axis.weight_n == pytest.approx(weight_n + pull_n)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("motor_n", [700.0, None])
def test_an_encoder_is_further_in_by_stop_and_screw(direction: int, motor_n: float | None) -> None:
    """x_stop + d (F/k + b/2 + M/j): 500 N on 10 N/um, M of the motor on 20 N/um, backlash 4 um.

    The force of the motor has the sign of its direction, that at the stop none.
    """
    values = {
        "stop_direction": direction, "stop_position": 0.1, "stop_stiffness": 1e7,
        "effective_mass": 100.0, "screw_stiffness": 2e7, "backlash": 4e-6,
    }  # fmt: skip
    plant = PlantRecord({name: PlantValue(float(value)) for name, value in values.items()})
    names = ("actual_mm", "truth_mm", "velocity_mm_s", "drive_lag_mm", "set_mm", "cnc_lag_mm")
    columns = {f"Z.{name}": np.zeros(ROWS) for name in names}
    columns["Z.stop_force_n"] = np.full(ROWS, 500.0)
    if motor_n is not None:
        columns["Z.force_n"] = np.full(ROWS, direction * motor_n)
    axes = {"Z": AxisRecord("can1", 1, 1000.0, plant="z")}
    observed = Observed(facts(axes=axes, plants={"z": plant}), at_rest(**columns))
    found = axis_truth(observed, "Z", 0.0).pressed_encoder_mm(3)
    screw_n = 500.0 if motor_n is None else motor_n
    assert found == pytest.approx(100.0 + direction * (0.05 + 0.002 + screw_n / 2e4))


@pytest.mark.parametrize(
    ("force_n", "rows", "beside_n"),
    [
        ([0, 1, 2, 3, 4, 5], slice(1, 4), 1.0),  # it goes on to rise between the last two SYNCs
        ([5, 4, 3, 2, 1, 0], slice(2, 5), 1.0),  # or has fallen before the first one
        ([0, 1, 9, 3, 4, 5], slice(1, 4), 0.0),
        ([0, 1, 2, 3, 4, 5], slice(3, 6), 0.0),  # nothing comes after the recording
        ([5, 4, 3, 2, 1, 0], slice(0, 3), 0.0),
    ],
)
def test_the_largest_force_of_a_run_may_lie_beside_its_rows(
    force_n: list[float], rows: slice, beside_n: float
) -> None:
    forces = np.array(force_n, dtype=float)
    names = ("actual_mm", "truth_mm", "velocity_mm_s", "drive_lag_mm", "set_mm", "cnc_lag_mm")
    columns = {f"Z.{name}": np.zeros(len(forces)) for name in names}
    table = pa.table({"time_ns": TIMES[: len(forces)], **columns, "Z.stop_force_n": forces})
    axes, plants = {"Z": AxisRecord("can1", 1, 1000.0, plant="z")}, {"z": PlantRecord({})}
    truth = axis_truth(Observed(facts(axes=axes, plants=plants), Series(table)), "Z", 0.0)
    assert truth.force_beside_n(rows) == beside_n


def test_the_peak_before_the_first_row_is_not_one_of_the_rows() -> None:
    """Peaks are of the time since the row before; the force at the first row itself counts."""
    forces, peaks = np.array([0.0, 4.0, 3.0, 2.0]), np.array([0.0, 9.0, 5.0, 3.5])
    names = ("actual_mm", "truth_mm", "velocity_mm_s", "drive_lag_mm", "set_mm", "cnc_lag_mm")
    columns = {f"Z.{name}": np.zeros(4) for name in names}
    columns |= {"Z.stop_force_n": forces, "Z.stop_force_peak_n": peaks}
    table = pa.table({"time_ns": TIMES[:4], **columns})
    axes, plants = {"Z": AxisRecord("can1", 1, 1000.0, plant="z")}, {"z": PlantRecord({})}
    truth = axis_truth(Observed(facts(axes=axes, plants=plants), Series(table)), "Z", 0.0)
    found = [truth.stop_force_max_n(slice(first, 4)) for first in (0, 1, 2, 3, 4)]
    assert found == [9.0, 5.0, 3.5, 2.0, None]


@pytest.mark.parametrize(
    ("set_mm", "end_row", "rows"),
    [
        ([5, 4, 3, 3, 3, 3, 2, 1], 3, (3, 7)),  # the first new value was made after its SYNC
        ([5, 4, 3, 3, 4, 3, 3, 3], 2, (2, 5)),  # it ends where it moves, and stays so
        ([5, 4, 3, 3, 3, 3, 3, 3], 4, (4, 8)),  # to the end of the recording
        ([5, 4, 3, 3, 3, 3, 3, 2], 7, (7, 8)),
    ],
)
def test_after_a_run_an_axis_stands_until_its_set_value_changes(
    set_mm: list[float], end_row: int, rows: tuple[int, int]
) -> None:
    run: Any = SimpleNamespace(
        end_ns=0, row_at=lambda _: end_row, set_mm={"Z": np.array(set_mm)}.__getitem__
    )
    truth: Any = SimpleNamespace(name="Z")
    assert _standing_rows(run, truth) == slice(*rows)


# Distance control


def test_what_the_plc_gave_in_the_same_cycle_is_kept_beside_the_value_of_the_program() -> None:
    """SET_POS in row 5, SET_DIST in rows 7 and 9; the PLC gave one of them before, in row 7."""

    def order(row: int, by: str, **values: float) -> DistanceOrder:
        return DistanceOrder(row * MS, by, **values)

    orders = (
        order(5, "NC", set_pos_mm=3.0),
        order(7, "PLC", set_dist_mm=1.5),
        order(7, "NC", set_dist_mm=2.5),
        order(9, "NC", set_dist_mm=2.0),
    )
    observed = Observed(facts(timing=Timing(MS, 600_000, 2)), at_rest())
    found = set_by_program(observed, DistanceRecord(orders=orders))
    assert found == {"set_pos_mm": {5: None}, "set_dist_mm": {7: 1.5, 9: None}}
