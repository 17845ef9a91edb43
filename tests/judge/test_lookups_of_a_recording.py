"""What judges look up in a recording: SYNCs of a segment, columns of a turning axis, probes."""

from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord, PlantRecord, ProbeRecord
from axisrig.bench.record.measuring import MeasurementRun, PlcTaskRecord
from axisrig.bench.record.series import MissingSignalError
from axisrig.kernel.time.clock import MS, US

ROWS = 40


def axis(**of: Any) -> AxisRecord:
    return AxisRecord("can1", 1, 1000.0, **of)


def recorded(columns: dict[str, Any], axes: dict[str, AxisRecord], **of_facts: Any) -> Observed:
    """A SYNC every ms where the columns have no times."""
    rows = len(next(iter(columns.values()))) if columns else ROWS
    times = {"time_ns": np.arange(rows, dtype=np.int64) * MS}
    table = pa.table({**times, **columns})
    return Observed(facts(axes=axes, **of_facts), kept(table))


# SYNCs of a segment


def synced(after_us: Any, lost: tuple[int, ...] = ()) -> Observed:
    """Z in a segment whose SYNCs come later. lost: rows whose SYNC nobody got, at their begin."""
    after = np.broadcast_to(np.asarray(after_us), (ROWS,)).astype(np.int64) * US
    place = np.arange(float(ROWS))
    for row in lost:
        after[row], place[row] = 0, place[row - 1] if row else 0.0
    columns = {"Z.sync_after_ns": after, "Z.actual_mm": place, "X.actual_mm": np.arange(ROWS) * 1.0}
    return recorded(columns, {"X": axis(), "Z": axis()})


def test_a_segment_has_its_own_syncs_and_one_without_a_column_those_of_the_rows() -> None:
    after_us = np.arange(ROWS) % 3 * 100
    observed = synced(after_us)
    assert observed.syncs_ns("Z").tolist() == [k * MS + k % 3 * 100 * US for k in range(ROWS)]
    assert observed.syncs_ns("X").tolist() == [k * MS for k in range(ROWS)]
    assert [observed.sync_ns("Z", row) for row in (4, 5, 39)] == [
        4 * MS + 100 * US, 5 * MS + 200 * US, 39 * MS,
    ]  # fmt: skip


@pytest.mark.parametrize("count", [1, 2, 7, 20])
def test_lost_syncs_in_a_row_count_from_the_last_one_that_came(count: int) -> None:
    """Each is so many periods after it: a SYNC that came 64 us after the begin of its cycle."""
    lost = tuple(range(10, 10 + count))
    observed = synced(64, lost)
    for row in (9, *lost, 10 + count):
        assert observed.sync_ns("Z", row) == row * MS + 64 * US


def test_beyond_twenty_lost_syncs_the_time_of_the_row_counts() -> None:
    observed = synced(64, tuple(range(10, 35)))
    assert observed.sync_ns("Z", 29) == 29 * MS + 64 * US
    assert observed.sync_ns("Z", 30) == 30 * MS


def test_before_the_first_sync_the_time_of_the_row_counts() -> None:
    observed = synced(64, (0, 1, 2))
    assert [observed.sync_ns("Z", row) for row in range(4)] == [0, MS, 2 * MS, 3 * MS + 64 * US]


@pytest.mark.parametrize(
    ("at_us", "row"),
    [
        (0, 0),  # before the first one: there is no other row
        (299, 0), (300, 0), (1299, 0), (1300, 1), (1999, 1), (2000, 1), (2299, 1), (2300, 2),
        (39_299, 38), (39_300, 39), (90_000, 39),
    ],
)  # fmt: skip
def test_the_last_sync_of_a_segment_is_by_its_own_instants(at_us: int, row: int) -> None:
    observed = synced(300)
    assert observed.sync_index_at("Z", at_us * US) == row
    assert observed.sync_index_at("X", at_us * US) == min(at_us // 1000, ROWS - 1)


def test_a_sync_that_nobody_got_is_where_it_had_to_come() -> None:
    """0.9 ms after the begin of a cycle; row 5 has the begin of the next one in its place."""
    times = np.arange(ROWS, dtype=np.int64) * MS + 900 * US
    place = np.arange(float(ROWS))
    times[5], place[5] = 6 * MS, place[4]
    observed = recorded({"time_ns": times, "Z.actual_mm": place}, {"Z": axis()})
    found = [observed.sync_index_at("Z", 5 * MS + us * US) for us in (899, 900, 950, 1000, 1899)]
    assert found == [4, 5, 5, 5, 5]


# Columns of axes that turn


def test_an_axis_that_turns_has_its_columns_under_names_of_angles_and_torques() -> None:
    """A torque over its arm is a force; one whose plant does not turn has forces as they are."""
    columns = {
        "C.actual_deg": [1.0, 2.0, 3.0], "C.superposed_mm": [4.0, 5.0, 6.0],
        "C.torque_nm": [1.0, 2.0, 3.0], "A.force_n": [7.0, 8.0, 9.0], "A.set_deg": [0.0, 1.0, 2.0],
        "Z.actual_mm": [9.0, 8.0, 7.0], "Z.force_n": [1.0, 1.0, 2.0],
    }  # fmt: skip
    axes = {
        "C": axis(is_rotary=True, arm_m=0.25, torque_arm_m=0.5),
        "A": axis(is_rotary=True),
        "Z": axis(),
    }
    observed = recorded(columns, axes)
    assert observed.column("C", "actual_mm").tolist() == [1.0, 2.0, 3.0]
    assert observed.column("C", "superposed_mm").tolist() == [4.0, 5.0, 6.0], "of an older one"
    assert observed.column("C", "force_n").tolist() == [2.0, 4.0, 6.0]
    assert observed.column("A", "force_n").tolist() == [7.0, 8.0, 9.0]
    assert observed.value("A", "set_mm", 2) == 2.0
    assert observed.column("Z", "force_n", slice(1, 3)).tolist() == [1.0, 2.0]
    there = [(a, name) for a in "CAZ" for name in ("actual_mm", "set_mm", "force_n", "torque_nm")
             if observed.has(a, name)]  # fmt: skip
    assert there == [
        ("C", "actual_mm"), ("C", "force_n"), ("C", "torque_nm"), ("A", "set_mm"),
        ("A", "force_n"), ("Z", "actual_mm"), ("Z", "force_n"),
    ]  # fmt: skip
    with pytest.raises(MissingSignalError, match=r"A\.actual_mm"):
        observed.column("A", "actual_mm")


@pytest.mark.parametrize(
    ("of_axis", "column", "force_n"),
    [
        ({"is_rotary": True, "arm_m": 0.25, "torque_arm_m": 0.5}, "C.torque_nm", 6.0),
        ({"is_rotary": True, "torque_arm_m": 0.5}, "C.torque_nm", 6.0),
        ({"is_rotary": True, "arm_m": 0.25}, "C.force_n", 3.0),
        ({"torque_arm_m": 0.5}, "C.force_n", 3.0),
    ],
)
def test_forces_are_torques_where_an_axis_turns_and_has_an_arm_of_them(
    of_axis: dict[str, Any], column: str, force_n: float
) -> None:
    observed = recorded({column: [3.0]}, {"C": axis(**of_axis)})
    assert observed.has("C", "force_n")
    assert observed.value("C", "force_n", 0) == force_n


def test_an_arm_of_torques_is_none_where_the_plant_of_an_axis_does_not_turn() -> None:
    axes = {"C": axis(is_rotary=True, torque_arm_m=0.5), "A": axis(is_rotary=True), "Z": axis()}
    observed = recorded({}, axes)
    assert [observed.torque_arm_m(name) for name in axes] == [0.5, None, None]
    assert [observed.is_rotary(name) for name in axes] == [True, True, False]


@pytest.mark.parametrize(("place_mm", "after_us"), [(9.0, 64), (10.0, 0)])
def test_without_an_actual_position_a_sync_at_the_begin_of_a_cycle_is_lost(
    place_mm: float, after_us: int
) -> None:
    """With one it has come where the position is a new one: row 9 has 9 mm."""
    after = np.full(ROWS, 64 * US)
    after[10] = 0
    place = np.arange(float(ROWS))
    place[10] = place_mm
    bare = recorded({"Z.sync_after_ns": after}, {"Z": axis()})
    assert bare.sync_ns("Z", 10) == 10 * MS + 64 * US
    known = recorded({"Z.sync_after_ns": after, "Z.actual_mm": place}, {"Z": axis()})
    assert known.sync_ns("Z", 10) == 10 * MS + after_us * US


# Plants and probes


def test_the_plant_of_an_axis_is_by_its_name() -> None:
    slow, fast = PlantRecord(kv_per_s=20.0), PlantRecord(kv_per_s=60.0)
    axes = {"X": axis(plant="b"), "Z": axis(plant="a"), "C": axis(is_outside=True)}
    observed = recorded({}, axes, plants={"a": slow, "b": fast})
    assert [observed.plant_of(name) for name in axes] == [fast, slow, None]


NEAR, FAR, AT_PLC = (ProbeRecord(True, known_ns, (), ()) for known_ns in (1.0, 2.0, 3.0))
PROBES = {"near": NEAR, "far": FAR, "box": AT_PLC}
TASK = PlcTaskRecord(MS, 0, 0, MS, 0, probes=("box", "near"))
WIRES = {"X": {"probe_1": "near", "probe_2": "far"}, "Z": {"probe_1": "far"}, "C": {}}


@pytest.mark.parametrize(
    ("axes", "inputs", "sources", "task", "probes"),
    [
        ("X", {"X": 1}, {"X": "DRIVE"}, None, ["near"]),
        ("X", {"X": 2}, {"X": "DRIVE"}, None, ["far"]),
        ("XZ", {"X": 1, "Z": 1}, {}, None, ["near", "far"]),
        ("ZX", {"X": 1, "Z": 1}, {}, None, ["far", "near"]),
        ("XZ", {"X": 2, "Z": 1}, {}, None, ["far"]),  # one probe at both is one
        ("Z", {"Z": 2}, {}, None, []),  # nothing is wired there
        ("CX", {"C": 1, "X": 1}, {}, None, ["near"]),
        ("Z", {"Z": 1}, {"Z": "PLC"}, TASK, ["box", "near"]),
        ("Z", {"Z": 1}, {"Z": "DRIVE"}, TASK, ["far"]),
        ("Z", {"Z": 1}, {"X": "PLC"}, TASK, ["far"]),  # another axis has its signal there
        ("XZ", {"X": 1, "Z": 1}, {"X": "DRIVE", "Z": "PLC"}, TASK, ["near", "box"]),
        ("Z", {"Z": 1}, {"Z": "PLC"}, PlcTaskRecord(MS, 0, 0, MS, 0), ["far"]),  # no terminal
        ("Z", {"Z": 1}, {"Z": "PLC"}, None, ["far"]),
    ],
)
def test_the_probes_of_a_run_are_those_at_the_inputs_in_use(
    axes: str,
    inputs: dict[str, int],
    sources: dict[str, str],
    task: PlcTaskRecord | None,
    probes: list[str],
) -> None:
    run = MeasurementRun(tuple(axes), inputs=inputs, sources=sources)
    records = {name: axis(signals=wires) for name, wires in WIRES.items()}
    observed = recorded({}, records, probes=PROBES, plc_task=task)
    assert observed.probes_of(run) == [PROBES[name] for name in probes]


@pytest.mark.parametrize(
    ("homed_ms", "zero_mm"),
    [
        ((), 0.0),
        ((4,), 7.5),
        ((5,), 7.5),
        ((6,), 0.0),
        ((1, 3), 7.5),
        ((1, 6), None),
        ((6, 9), 0.0),
    ],
)
def test_a_drive_counts_from_what_the_last_homing_before_the_run_has_set(
    homed_ms: tuple[int, ...], zero_mm: float | None
) -> None:
    homed = axis(homed_ns=tuple(at * MS for at in homed_ms), origin_mm=7.5)
    run = MeasurementRun(("Z",), begin_ns=5 * MS)
    observed = recorded({}, {"X": axis(homed_ns=(MS,), origin_mm=3.0), "Z": homed})
    assert observed.zero_mm("Z", run) == zero_mm


# Rows


@pytest.mark.parametrize(
    ("begin_us", "end_us", "rows"),
    [
        (0, 0, (0, 1)), (1000, 3000, (1, 4)), (1001, 2999, (2, 3)), (1001, 1999, (2, 2)),
        (0, 99_000, (0, 40)), (39_000, 39_000, (39, 40)), (39_001, 99_000, (40, 40)),
        (5000, 4000, (5, 5)),  # an interval that ends before it begins has no row
    ],
)  # fmt: skip
def test_rows_between_two_instants_have_both_ends_in_them(
    begin_us: int, end_us: int, rows: tuple[int, int]
) -> None:
    found = recorded({}, {}).between(begin_us * US, end_us * US)
    assert (found.start, found.stop) == rows


def test_the_row_at_an_instant_is_that_of_the_last_sync() -> None:
    times = np.arange(ROWS, dtype=np.int64) * MS + 5 * MS
    observed = recorded({"time_ns": times}, {})
    found = [observed.index_at(at_us * US) for at_us in (0, 4999, 5000, 5999, 6000, 44_000, 99_000)]
    assert found == [0, 0, 0, 0, 1, 39, 39]
