"""Metrics of a signal at a PLC on recordings that were never run: bounce, node, exact instants."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.record.axes import AxisRecord, Edge, ProbeRecord
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.measuring import MeasurementRun, PlcTaskRecord
from axisrig.bench.record.series import Series
from axisrig.bench.tools.budget.instants import instants_at_plc
from axisrig.kernel.time.clock import MS, US

PLANS = Path(__file__).parents[2] / "testplans"
SPEED_MM_S = -10.0
SYNC_NS, CYCLE_NS = 48 * US, 600 * US
TIMING = Timing(MS, CYCLE_NS, 0)
TASK = PlcTaskRecord(2 * MS, 300 * US, 0, 2 * MS, 300 * US, probes=("probe",))


def place_mm(time_ns: int) -> float:
    return 100.0 + SPEED_MM_S * time_ns * 1e-9


def left(
    edges: Sequence[tuple[int, bool]],
    cycle_ns: int,
    at_ns: int,
    *,
    task: PlcTaskRecord = TASK,
    source: str = "PLC",
    telegrams_us: Sequence[int] | None = None,
    known_ns: float = 1.0,
    timing: Timing = TIMING,
    after_ns: int | None = None,
    lost: Sequence[int] = (),
) -> Observed:
    """Z goes down; cycle_ns: that saw the signal; at_ns: whose position it published."""
    times = np.arange(40, dtype=np.int64) * timing.period_ns + SYNC_NS
    times[list(lost)] -= SYNC_NS  # no drive has got it: when it was asked for
    columns: dict[str, Any] = {
        "time_ns": times,
        "Z.truth_mm": [place_mm(int(t)) for t in times],
        "Z.velocity_mm_s": np.full(len(times), SPEED_MM_S),
    }
    if after_ns is not None:
        columns["Z.sync_after_ns"] = np.full(len(times), after_ns)
    if telegrams_us is not None:
        columns["plc.inputs_frame_ns"] = [
            [us * US for us in telegrams_us if t <= us * US < t + timing.period_ns] for t in times
        ]
    run = MeasurementRun(
        ("Z",),
        sources={"Z": source},
        inputs={"Z": 1},
        begin_ns=0,
        signal_ns=cycle_ns,
        end_ns=30 * MS,
        latched_mm={"Z": place_mm(at_ns)},
    )
    found: Facts = facts(
        timing=timing,
        end_ns=39 * MS,
        axes={"Z": AxisRecord("can1", 1, 1000.0, plant="z")},
        probes={"probe": ProbeRecord(True, known_ns, (), tuple(Edge(*edge) for edge in edges))},
        plc_task=task,
        runs=(run,),
    )
    return Observed(found, Series(pa.table(columns)))


def found(observed: Observed) -> tuple[Observation, Observation]:
    late, error = (
        observe(observed, parse_check(name, "> -1e9", ""))
        for name in ("signal_late_cycles", "source_error_um")
    )
    return late, error


def test_a_kernel_that_is_a_cycle_late_is_seen_with_a_node_and_a_fast_plc() -> None:
    """SYNC at 10.048, telegram until 10.348 though the worst case of the bus is 0.414 ms after the
    SYNC; a PLC cycle at 10.4, the NC cycle at 10.6 has the level.
    """
    task = replace(
        TASK, period_ns=200 * US, offset_ns=0, terminal_ns=MS, terminal_offset_ns=SYNC_NS,
        terminal_late_ns=414 * US,
    )  # fmt: skip
    telegrams_us = [n * 1000 + 348 for n in range(40)]
    edges = [(10 * MS, True)]
    for cycles in (0, 1):
        cycle_ns = 10 * MS + CYCLE_NS + cycles * MS
        sync_ns = 10 * MS + SYNC_NS + cycles * MS
        late, error = found(left(edges, cycle_ns, sync_ns, task=task, telegrams_us=telegrams_us))
        assert (late.value, late.uncertainty) == (cycles, 0.0)
        assert error.value == pytest.approx(SPEED_MM_S * cycles, abs=1e-6)
        assert error.uncertainty == 0.0
    # Without the telegrams it may have been either: in the worst case they come after the PLC cycle
    slow = replace(task, terminal_late_ns=500 * US)
    late, error = found(left(edges, 10 * MS + CYCLE_NS, 10 * MS + SYNC_NS, task=slow))
    assert (late.value, late.uncertainty) == (-1.0, 1.0)
    assert error.value == pytest.approx(10.0)
    assert error.uncertainty == pytest.approx(10.0)


def test_a_probe_that_bounces_counts_where_its_level_is_on_at_an_exchange() -> None:
    """On 10.0 to 12.0 ms, on again from 13.0: not at the exchange at 12.3, at 14.3; cycle 14.6."""
    edges = [(10_400 * US, True), (12 * MS, False), (13 * MS, True)]
    late, error = found(left(edges, 14 * MS + CYCLE_NS, 14 * MS + SYNC_NS))
    assert (late.value, late.uncertainty) == (0.0, 0.0)
    assert error.value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("edge_us", "cycle_ms", "unknown_cycles"),
    [
        (12_400, 14, 2.0),  # 0.2 ms earlier the exchange at 12.3 has it, and cycle 12.6
        (12_200, 12, 2.0),  # 0.2 ms later only that at 14.3
        (12_600, 14, 0.0),
        (12_000, 12, 0.0),
    ],
)
def test_an_edge_may_have_been_earlier_or_later_by_what_is_known_of_it(
    edge_us: int, cycle_ms: int, unknown_cycles: float
) -> None:
    at_ns = cycle_ms * MS
    observed = left([(edge_us * US, True)], at_ns + CYCLE_NS, at_ns + SYNC_NS, known_ns=200_000.0)
    late, error = found(observed)
    assert (late.value, late.uncertainty) == (0.0, unknown_cycles)
    assert error.value == pytest.approx(0.0, abs=1e-9)
    assert error.uncertainty == pytest.approx(-SPEED_MM_S * unknown_cycles, abs=1e-6)
    assert ("before or behind a cycle" in late.note) is bool(unknown_cycles)
    assert ("before or behind a cycle" in error.note) is bool(unknown_cycles)


@pytest.mark.parametrize("names", [("probe", "other"), ("other", "probe")])
def test_of_two_probes_at_the_plc_the_first_that_is_seen_counts(names: tuple[str, str]) -> None:
    """On at 10.4 and at 14.5 ms: the exchange at 12.3 has the first, whichever probe it is."""
    courses = ((10_400 * US, 20 * MS), (14_500 * US, 21 * MS))
    observed = left([], 12 * MS + CYCLE_NS, 12 * MS + SYNC_NS)
    probes = {
        name: ProbeRecord(True, 1.0, (), (Edge(on_ns, True), Edge(off_ns, False)))
        for name, (on_ns, off_ns) in zip(names, courses, strict=True)
    }
    task = replace(TASK, probes=("probe", "other"))
    both = replace(observed.facts, probes=probes, plc_task=task)
    late, error = found(Observed(both, observed.series))
    assert (late.value, late.uncertainty) == (0.0, 0.0)
    assert error.value == pytest.approx(0.0, abs=1e-9)


def test_a_pulse_that_nobody_looks_at_gives_no_value() -> None:
    late, error = found(left([(10_400 * US, True), (12 * MS, False)], 14 * MS, 14 * MS))
    assert (late.value, error.value) == (None, None)
    assert "never looks" in late.note


@pytest.mark.parametrize(("off_ns", "uncertainty"), [(-1, 0.0), (0, 2.0), (1, 0.0)])
def test_an_edge_at_the_very_instant_of_an_exchange_may_count_or_not(
    off_ns: int, uncertainty: float
) -> None:
    """Whole nanoseconds: a tenth of one before the exchange at 10.3 ms or behind it."""
    edges = [(10_300 * US + off_ns, True)]
    cycle_ms, seen_ms = 10 if off_ns <= 0 else 12, 12 if off_ns >= 0 else 10
    late, error = found(left(edges, seen_ms * MS + CYCLE_NS, seen_ms * MS + SYNC_NS))
    assert (late.value, late.uncertainty) == (seen_ms - cycle_ms, uncertainty)
    assert error.value == pytest.approx(SPEED_MM_S * (seen_ms - cycle_ms), abs=1e-6)
    assert error.uncertainty == pytest.approx(-SPEED_MM_S * uncertainty, abs=1e-6)


def test_edges_that_the_plant_knows_badly_make_the_instant_known_badly() -> None:
    """Of an FMU that gives a level only, known to 50 us; the exchange is 20 us behind the edge."""
    edges = [(10_280 * US, True)]
    observed = left(edges, 10 * MS + CYCLE_NS, 10 * MS + SYNC_NS, known_ns=50e3)
    late, error = found(observed)
    assert (late.value, late.uncertainty) == (0.0, 2.0)
    assert error.uncertainty == pytest.approx(20.0)


@pytest.mark.parametrize("keeps_last", [False, True])
def test_a_stamp_is_that_of_the_first_or_the_last_edge_of_an_exchange(keeps_last: bool) -> None:
    """Rising at 10.4 and 12.2 ms, off between, the exchange at 12.3 has both."""
    edges = [(10_400 * US, True), (12 * MS, False), (12_200 * US, True)]
    at_ns = (12_200 if keeps_last else 10_400) * US
    task = replace(TASK, keeps_last_stamp=keeps_last, stamp_jitter_ns=1000)
    observed = left(edges, 12 * MS + CYCLE_NS, at_ns, task=task, source="PLC_TIMESTAMP")
    late, error = found(observed)
    assert late.value == 0.0
    assert error.value == pytest.approx(0.0, abs=1e-6)
    assert error.uncertainty == pytest.approx(0.01, rel=2e-3)  # 10 mm/s in 1 us, and in 1 ns


@pytest.mark.parametrize(
    ("axis", "noted_mm", "latch_ns", "error_um"),
    [
        ("Z", -0.0005, 10_400 * US, 0.5),
        ("Z", None, 10_400 * US, 0.0),  # the plant does not know it
        ("X", -0.0005, 10_400 * US, 0.0),  # another axis
        ("Z", -0.0005, 10_380 * US, 0.0),  # another instant
        ("Z", -0.0005, 10_400 * US - 500, 0.5),  # carried on with the speed
    ],
)
def test_the_place_that_the_plant_has_noted_counts_before_one_between_two_syncs(
    axis: str, noted_mm: float | None, latch_ns: int, error_um: float
) -> None:
    """It is 0.5 um from what lies between the rows; the published value is what lies between."""
    at_ns = 10_400 * US
    edges = [(at_ns, True)]
    observed = left(edges, 12 * MS + CYCLE_NS, at_ns, source="PLC_TIMESTAMP")
    seen_mm = None if noted_mm is None else place_mm(latch_ns) + noted_mm
    row = EdgeTruth("probe", axis, True, at_ns, None, None, latch_ns, seen_mm, seen_mm)
    noted = Observed(replace(observed.facts, edges=(row,)), observed.series)
    assert found(noted)[1].value == pytest.approx(error_um, abs=1e-6)
    assert found(observed)[1].value == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("turn", [1, -1])
def test_of_several_noted_places_the_nearest_one_counts(turn: int) -> None:
    """One of another edge, 0.8 us before, is 5 um off; that of the instant itself 0.5 um."""
    at_ns = 10_400 * US
    observed = left([(at_ns, True)], 12 * MS + CYCLE_NS, at_ns, source="PLC_TIMESTAMP")
    rows = tuple(
        EdgeTruth("probe", "Z", True, ns, None, None, ns, place_mm(ns) + mm, place_mm(ns) + mm)
        for ns, mm in ((at_ns - 800, 0.005), (at_ns, -0.0005))[::turn]
    )
    noted = Observed(replace(observed.facts, edges=rows), observed.series)
    assert found(noted)[1].value == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(
    ("true_ns", "true_ppm", "assumed_ns", "assumed_ppm"),
    [(100 * US, 0.0, 60 * US, 0.0), (0, 400.0, 0, -100.0), (-30 * US, 50.0, 10 * US, 50.0)],
)
def test_a_stamp_is_believed_by_what_the_cnc_assumes_of_the_clock(
    true_ns: int, true_ppm: float, assumed_ns: int, assumed_ppm: float
) -> None:
    """The terminal shows t + offset + drift t; the CNC takes its own offset and drift out again."""
    edge_ns = 10_400 * US
    shown_ns = edge_ns * (1.0 + true_ppm * 1e-6) + true_ns
    believed_ns = round((shown_ns - assumed_ns) / (1.0 + assumed_ppm * 1e-6))
    task = replace(
        TASK,
        clock_offset_ns=true_ns,
        clock_drift_ppm=true_ppm,
        assumed_offset_ns=assumed_ns,
        assumed_drift_ppm=assumed_ppm,
    )
    cycle_ns = 12 * MS + CYCLE_NS
    observed = left([(edge_ns, True)], cycle_ns, believed_ns, task=task, source="PLC_TIMESTAMP")
    assert found(observed)[1].value == pytest.approx(0.0, abs=2e-5)  # 10 mm/s in 2 ns


def test_what_a_latch_is_believed_within_counts_in_micrometres() -> None:
    """0.25 mm are 250 um."""
    edges = [(10_280 * US, True)]
    observed = left(edges, 10 * MS + CYCLE_NS, 10 * MS + SYNC_NS)
    (run,) = observed.facts.runs
    doubted = replace(observed.facts, runs=(replace(run, doubt_mm={"Z": 0.25}),))
    sure, unsure = found(observed)[1], found(Observed(doubted, observed.series))[1]
    assert unsure.uncertainty - sure.uncertainty == pytest.approx(250.0)
    assert "unproved: believed within 0.25 mm" in unsure.note


def test_external_hardware_keeps_what_it_has_seen_for_a_slow_cnc() -> None:
    """PLC each 0.5 ms, CNC each 3 ms: on for 0.6 ms only. The CNC has it by the latch alone."""
    task = replace(TASK, period_ns=MS // 2, offset_ns=0, terminal_ns=MS // 2, terminal_offset_ns=0)
    timing = Timing(3 * MS, CYCLE_NS, 0)
    edges = [(9_900 * US, True), (10_500 * US - 1, False)]
    for source, value in (("PLC", None), ("PLC_EXT_LATCH_CONTROL", 0.0)):
        observed = left(
            edges, 12 * MS + CYCLE_NS, 12 * MS + SYNC_NS, task=task, source=source, timing=timing
        )
        assert found(observed)[0].value == value


@pytest.mark.parametrize(("busy_us", "sync_ms"), [(0, 10), (200, 10), (400, 11), (2500, 15)])
def test_the_time_that_the_plc_needs_counts(busy_us: int, sync_ms: int) -> None:
    """Read at 10.3 ms, written so much later, seen at 10.6, 11.6 ...; above 2 ms read at 12.3."""
    task = replace(TASK, busy_ns=busy_us * US)
    edges = [(10 * MS, True)]
    observed = left(edges, sync_ms * MS + CYCLE_NS, sync_ms * MS + SYNC_NS, task=task)
    late, error = found(observed)
    assert late.value == 0.0
    assert error.value == pytest.approx(0.0, abs=1e-9)
    seen = touch(observed, "Z")
    assert seen is not None
    case = next(c for c in read_plan(PLANS / "plc_sources.csv").cases if c.case == "plc-f600")
    instants = instants_at_plc(observed, seen, "Z", settings_of(case))
    assert instants is not None
    assert instants.value_ns == sync_ms * MS + SYNC_NS


@pytest.mark.parametrize(("busy_us", "sync_ms"), [(0, 12), (400, 13)])
def test_it_counts_with_a_probe_at_the_drive_too(busy_us: int, sync_ms: int) -> None:
    """60FD of the SYNC at 10.048 is shown at 10.6, read at 12.3, seen at 12.6 or a cycle later."""
    task = replace(TASK, busy_ns=busy_us * US, probes=())
    observed = left([(10 * MS, True)], 0, 0, task=task)
    axis = replace(observed.axes["Z"], signals={"probe_1": "probe"})
    observed = Observed(replace(observed.facts, axes={"Z": axis}), observed.series)
    seen = touch(observed, "Z")
    assert seen is not None
    case = next(c for c in read_plan(PLANS / "plc_sources.csv").cases if c.case == "plc-f600")
    instants = instants_at_plc(observed, seen, "Z", settings_of(case))
    assert instants is not None
    assert (instants.sampled_ns, instants.value_ns) == (10 * MS + SYNC_NS, sync_ms * MS + SYNC_NS)


@pytest.mark.long
@pytest.mark.parametrize("after_us", [0, 64])
@pytest.mark.parametrize("source", ["PLC", "PLC_FIRST_EVENT", "PLC_EXT_LATCH_CONTROL"])
def test_a_position_is_of_the_sync_of_its_own_segment(source: str, after_us: int) -> None:
    """That one is 64 us later than the first: 10 mm/s go 0.64 um meanwhile, which is no error."""
    edges, cycle_ns, row_ns = [(10_280 * US, True)], 10 * MS + CYCLE_NS, 10 * MS + SYNC_NS
    own_ns = row_ns + after_us * US
    for at_ns, error_um in ((own_ns, 0.0), (row_ns, -SPEED_MM_S * after_us * 1e-3)):
        observed = left(edges, cycle_ns, at_ns, source=source, after_ns=after_us * US)
        late, error = found(observed)
        assert late.value == 0.0
        assert error.value == pytest.approx(error_um, abs=1e-6)
        seen = touch(observed, "Z")
        assert seen is not None
        case = next(c for c in read_plan(PLANS / "plc_sources.csv").cases if c.case == "plc-f600")
        instants = instants_at_plc(observed, seen, "Z", settings_of(case))
        assert instants is not None
        assert instants.value_ns == own_ns


def test_a_drive_samples_its_input_at_the_sync_of_its_own_segment() -> None:
    """The level is there at 10.1 ms: after the first SYNC, before that of its segment."""
    task = replace(TASK, probes=())
    for after_us, sampled_ns in ((0, 11 * MS + SYNC_NS), (64, 10 * MS + SYNC_NS + 64 * US)):
        observed = left([(10_100 * US, True)], 0, 0, task=task, after_ns=after_us * US)
        axis = replace(observed.axes["Z"], signals={"probe_1": "probe"})
        observed = Observed(replace(observed.facts, axes={"Z": axis}), observed.series)
        seen = touch(observed, "Z")
        assert seen is not None
        case = next(c for c in read_plan(PLANS / "plc_sources.csv").cases if c.case == "plc-f600")
        instants = instants_at_plc(observed, seen, "Z", settings_of(case))
        assert instants is not None
        assert instants.sampled_ns == sampled_ns


@pytest.mark.parametrize("lost", [(10,), (8, 9, 10), (10, 11)])
@pytest.mark.parametrize("after_ns", [None, 64 * US])
def test_a_sync_that_no_drive_has_got_is_where_it_would_have_come(
    lost: Sequence[int], after_ns: int | None
) -> None:
    """48 us after it was asked for, as the ones before, and later in another segment."""
    edges, cycle_ns = [(10_280 * US, True)], 10 * MS + CYCLE_NS
    own_ns = 10 * MS + SYNC_NS + (after_ns or 0)
    observed = left(edges, cycle_ns, own_ns, after_ns=after_ns, lost=lost)
    if after_ns is not None:  # of a drive that has got none it is not known
        table = observed.series.table()
        after = [0 if row in lost else after_ns for row in range(table.num_rows)]
        place = table.column_names.index("Z.sync_after_ns")
        table = table.set_column(place, "Z.sync_after_ns", pa.array(after))
        observed = Observed(observed.facts, Series(table))
    late, error = found(observed)
    assert (late.value, error.value) == (0.0, pytest.approx(0.0, abs=1e-6))


@pytest.mark.parametrize("terminal_ns", [2 * MS, 0])
@pytest.mark.parametrize(
    ("row_us", "is_new", "own_us"),
    [
        (10_000, False, 10_048),  # asked for, and nothing has come
        (10_300, False, 10_048),  # the exchange of the terminal, or the cycle of the PLC
        (10_300, True, 10_300),  # a SYNC that was late by chance
        (10_301, False, 10_301),  # a SYNC that was late, and its telegram missing
        (10_048, False, 10_048),
    ],
)
def test_a_row_is_lost_where_the_plant_stands_at_a_step_and_nothing_has_come(
    row_us: int, is_new: bool, own_us: int, terminal_ns: int
) -> None:
    task = replace(TASK, terminal_ns=terminal_ns)
    table = left([], 0, 0, task=task).series.table()
    times = table["time_ns"].to_numpy().copy()
    times[10] = row_us * US
    actual = np.arange(40.0) + 100.0
    actual[10] = actual[10] if is_new else actual[9]
    columns = {name: table[name] for name in table.column_names}
    columns |= {"time_ns": pa.array(times), "Z.actual_mm": pa.array(actual)}
    observed = Observed(left([], 0, 0, task=task).facts, Series(pa.table(columns)))
    assert [observed.sync_ns("Z", row) for row in (9, 10, 11)] == [
        *(9 * MS + SYNC_NS, own_us * US, 11 * MS + SYNC_NS),
    ]
    at_ns = own_us * US
    assert [observed.sync_index_at("Z", ns) for ns in (at_ns - 1, at_ns, 11 * MS)] == [9, 10, 10]
