"""Measurement runs of two axes, judged from a recording whose motion is known in closed form.

Z goes down from 100 mm with 10 mm/s, X up from 5 mm with 2 mm/s, one row each millisecond. The
run begins at 5 ms; the probe meets the workpiece at 10.4 ms, switches at 10.5 ms, the drive of Z
latches at 10.6 ms, the cycle at 12.6 ms brakes, the axes stand at 30.6 ms.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.latch.findings import latch_events
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import known_metrics, parse_check
from axisrig.bench.record.axes import (
    AxisRecord,
    Contact,
    Deflection,
    Edge,
    Latch,
    PlantRecord,
    ProbeRecord,
)
from axisrig.bench.record.bus import RealTime
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.measuring import FixedStop, MeasurementRun, PlcTaskRecord
from axisrig.kernel.time.clock import MS, US

ROWS = 40
TIMES = np.arange(ROWS, dtype=np.int64) * MS
TIMING = Timing(MS, 600 * US, 2)
LAG_MM, KV_PER_S = 0.02, 50.0
FINE_NS = 50 * US
BETWEEN_UM = 0.0162 * 1000.0 * 0.05e-3**2 * 1e3
"""Cubic across a jump of 1000 mm/s2 in a fine step of 50 us (docs/architecture.md)."""

CONTACTS = (
    Contact(4_999_999, {"z": 99.95, "x": 5.01}),
    Contact(10_400_000, {"z": 99.896, "x": 5.0208}),
    Contact(20 * MS, {"z": 99.8, "x": 5.04}),
)
EDGES = (Edge(4_999_999, True), Edge(10_500_000, True), Edge(20 * MS, False))
RUN = MeasurementRun(
    ("X", "Z"),
    inputs={"X": 1, "Z": 1},
    sources={"X": "DRIVE", "Z": "DRIVE"},
    begin_ns=5 * MS,
    signal_ns=12_600_000,
    end_ns=30_600_000,
    latched_mm={"Z": 99.8965},
)
PROBE = ProbeRecord(True, 1.0, CONTACTS, EDGES)


def table(turn: int = 1, **more: Any) -> pa.Table:
    columns = {
        "X.truth_mm": 5.0 + 2.0 * TIMES * 1e-9,
        "X.velocity_mm_s": np.full(ROWS, 2.0),
        "X.drive_lag_mm": np.full(ROWS, LAG_MM / 5.0),
        "Z.truth_mm": 100.0 - 10.0 * TIMES * 1e-9,
        "Z.velocity_mm_s": np.full(ROWS, -10.0),
        "Z.drive_lag_mm": np.full(ROWS, -LAG_MM),
        "Z.set_mm": np.arange(ROWS) ** 2.0,
        **more,
    }
    return pa.table({"time_ns": TIMES, **dict([*columns.items()][::turn])})


def axis(name: str, **of_axis: Any) -> AxisRecord:
    known = {"plant": name.lower(), "signals": {"probe_1": "probe"}}
    return AxisRecord("can1", 1, 1000.0, **{**known, **of_axis})


def recorded(
    run: MeasurementRun | None = RUN,
    probes: Mapping[str, ProbeRecord] | None = None,
    columns: Mapping[str, Any] | None = None,
    plants: Mapping[str, PlantRecord] | None = None,
    x: Mapping[str, Any] | None = None,
    z: Mapping[str, Any] | None = None,
    **changes: Any,
) -> Observed:
    latches = (Latch(4_999_999, 1), Latch(10_600_000, 1), Latch(20 * MS, 2))
    found = facts(
        timing=TIMING,
        fine_ns=FINE_NS,
        end_ns=int(TIMES[-1]),
        axes={"X": axis("X", **(x or {})), "Z": axis("Z", latches=latches, **(z or {}))},
        plants=plants or {"x": PlantRecord(), "z": PlantRecord(kv_per_s=KV_PER_S)},
        probes=probes or {"probe": PROBE},
        runs=() if run is None else (run,),
        **changes,
    )
    return Observed(found, kept(table(**(columns or {}))))


def seen(observed: Observed, metric: str) -> Observation:
    return observe(observed, parse_check(metric, "> -1e9", ""))


REST_MM = LAG_MM + 10.0 / KV_PER_S
FAR_MM = 10.0 * (30.6e-3 - 10.4e-3)


@pytest.mark.parametrize(
    ("metric", "value", "uncertainty"),
    [
        ("latch_mm", 99.8965, 0.0),  # of Z, which travels most
        ("reaction_ms", 2.1, 1e-6),
        ("standstill_mm:Z", 100.0 - 0.3, REST_MM),  # at the SYNC before 30.6 ms
        ("standstill_mm:X", 5.0 + 0.06, LAG_MM / 5.0),  # its FMU has no gain of a position loop
        ("contact_mm:Z", 99.896, 0.0),
        ("contact_mm:X", 5.0208, 0.0),
        ("contact_velocity_mm_s", -10.0, 0.0),
        ("contact_velocity_mm_s:X", 2.0, 0.0),
        # Whole ns of the drive and 1 ns of the edge at 10 mm/s, and the cubic in a fine step
        ("latch_error_um", 0.5, 10e3 * 2e-9 + BETWEEN_UM),
        ("contact_to_latch_ms", 0.2, 2e-6),
        ("contact_to_standstill_ms", 20.2, 1.0),
        ("overtravel_mm", FAR_MM, REST_MM),
        ("overtravel_mm:X", FAR_MM / 5.0, LAG_MM / 5.0),
    ],
)
def test_a_touch_is_judged_by_its_truth(metric: str, value: float, uncertainty: float) -> None:
    found = seen(recorded(), metric)
    assert found.value == pytest.approx(value, abs=1e-9)
    assert found.uncertainty == pytest.approx(uncertainty, rel=1e-6, abs=1e-9)


def test_what_a_probe_knows_badly_widens_every_value() -> None:
    """Edges known to 2000 ns; what moves with 10 mm/s goes 0.02 um meanwhile, X 0.004 um."""
    coarse = replace(PROBE, edge_uncertainty_ns=2000.0)
    sure, unsure = recorded(), recorded(probes={"probe": coarse})
    for metric, wider in (
        ("latch_mm:Z", 10.0 * 2e-6),
        ("contact_mm:Z", 10.0 * 2e-6),
        ("contact_mm:X", 2.0 * 2e-6),
        ("reaction_ms", 1999e-6),
        ("contact_to_latch_ms", 1999e-6),
        ("latch_error_um", 10e3 * 1999e-9),
        ("overtravel_mm", 10.0 * 2e-6),
        ("standstill_mm", 0.0),
    ):
        one, other = seen(sure, metric), seen(unsure, metric)
        assert one.value == other.value
        assert other.uncertainty - one.uncertainty == pytest.approx(wider, rel=1e-6, abs=1e-12)
        if "contact_mm" in metric or "latch_mm" in metric:
            assert "known to 2000 ns" in other.note
            assert "known to" not in one.note


def test_a_velocity_says_when_it_is_signed() -> None:
    observed = recorded()
    notes = [seen(observed, f"contact_velocity_mm_s:{name}").note for name in "ZX"]
    assert ["signed" in note for note in notes] == [True, False]


@pytest.mark.parametrize("turn", [1, -1])
def test_without_an_axis_it_is_the_one_that_travels_most(turn: int) -> None:
    """Whatever the order of the axes; outside by what the drives report."""
    run = replace(RUN, axes=RUN.axes[::turn], latched_mm={"X": 5.0, "Z": 99.0})
    assert seen(recorded(run), "latch_mm").value == 99.0
    reported = {"X.actual_mm": -20.0 * TIMES * 1e-9, "Z.actual_mm": 0.0 * TIMES}
    away = recorded(run, columns=reported, x={"is_outside": True}, z={"is_outside": True})
    assert away.moved_axis(run) == "X"
    still = replace(run, begin_ns=90 * MS, end_ns=95 * MS)
    assert recorded(still).moved_axis(still) == run.axes[0]


@pytest.mark.parametrize(
    ("signal_ns", "buffer_cycles", "way"),
    [(12_600_000, 2, (13, 30)), (12_600_000, 0, (11, 30)), (13_000_000, 2, (14, 30))],
)
def test_a_stop_begins_with_the_last_set_position_before_it_brakes(
    signal_ns: int, buffer_cycles: int, way: tuple[int, int]
) -> None:
    """Set positions are the squares of their rows; one is the buffer later on its way."""
    run = replace(RUN, signal_ns=signal_ns)
    observed = recorded(run)
    changed = replace(observed.facts, timing=replace(TIMING, buffer_cycles=buffer_cycles))
    first, last = way
    found = seen(Observed(changed, observed.series), "stop_way_mm:Z")
    assert found.value == last**2 - first**2


NONE = ProbeRecord(True, 1.0)
BLIND = ProbeRecord(False, 1.0)
ON = "the signal does not end this run (G106)"
MET_NOTHING = "the probe met nothing during the measurement run"
NO_CONTACT = "the FMU of the probe gives no contact (contact_count in docs/rigs.md)"


@pytest.mark.parametrize(
    ("metric", "changes", "note"),
    [
        ("latch_mm", {"run": None}, "the program made no measurement run"),
        ("latch_mm:X", {}, "no measured value of axis X"),
        ("reaction_ms", {"run": replace(RUN, goes_on=True)}, ON),
        ("reaction_ms", {"run": replace(RUN, signal_ns=None)}, "no edge was seen"),
        ("reaction_ms", {"probes": {"probe": NONE}}, "no edge was seen in the measurement run"),
        ("stop_way_mm", {"run": replace(RUN, goes_on=True)}, "no signal has ended"),
        ("stop_way_mm", {"run": replace(RUN, signal_ns=None)}, "no signal has ended"),
        ("contact_mm", {"probes": {"probe": NONE}}, MET_NOTHING),
        ("contact_mm", {"probes": {"probe": BLIND}}, NO_CONTACT),
        ("contact_mm:X", {"x": {"plant": "elsewhere"}}, "the probe does not belong to axis X"),
        ("overtravel_mm:X", {"x": {"plant": "elsewhere"}}, "the probe does not belong to axis X"),
        ("contact_velocity_mm_s", {"probes": {"probe": NONE}}, MET_NOTHING),
        ("latch_error_um:X", {}, "no measured value of axis X"),
        ("latch_error_um", {"z": {"plant": "elsewhere"}}, "the probe does not belong to axis Z"),
        ("latch_error_um", {"z": {"homed_ns": (MS, 35 * MS)}}, "axis Z was homed before and after"),
        ("contact_to_latch_ms:X", {}, "the drive of axis X latched nothing"),
        ("contact_to_standstill_ms", {"run": replace(RUN, end_ns=None)}, "did not end"),
        ("probe_deflection_mm_max", {"x": {"signals": {}}, "z": {"signals": {}}}, "no probe is wi"),
        ("probe_deflection_mm_max", {"probes": {"probe": BLIND}}, NO_CONTACT),
    ],
)
def test_a_value_that_is_missing_says_why(
    metric: str, changes: Mapping[str, Any], note: str
) -> None:
    found = seen(recorded(**changes), metric)
    assert found.value is None
    assert note in found.note


def test_a_contact_after_the_last_sync_has_no_velocity() -> None:
    late = ProbeRecord(True, 1.0, (Contact(int(TIMES[-1]) + 1, {"z": 9.0}),))
    open_end = replace(RUN, end_ns=60 * MS)
    found = seen(recorded(open_end, probes={"probe": late}), "contact_velocity_mm_s:Z")
    assert (found.value, found.note) == (None, "no SYNC came after the contact")


@pytest.mark.parametrize(
    ("homed_ns", "zero_mm"),
    [((), 0.0), ((MS,), 50.0), ((5 * MS,), 50.0), ((MS, 3 * MS), 50.0), ((5 * MS + 1,), 0.0)],
)
def test_a_value_counts_from_where_the_axis_was_homed_before_the_run(
    homed_ns: tuple[int, ...], zero_mm: float
) -> None:
    run = replace(RUN, latched_mm={"Z": 99.8965 - zero_mm})
    found = seen(recorded(run, z={"homed_ns": homed_ns, "origin_mm": 50.0}), "latch_error_um:Z")
    assert found.value == pytest.approx(0.5, abs=1e-6)


@pytest.mark.parametrize(
    ("begin_ns", "end_ns", "contact_ms"),
    [
        (10_400_000, 30 * MS, 10.4),  # both ends belong to the run
        (10_400_001, 20 * MS, 20.0),
        (0, 30 * MS, 4.999999),
        (10_400_001, 20 * MS - 1, None),
    ],
)
def test_a_contact_belongs_to_the_run_in_which_it_came(
    begin_ns: int, end_ns: int, contact_ms: float | None
) -> None:
    run = replace(RUN, begin_ns=begin_ns, end_ns=end_ns)
    for probes in ({"probe": PROBE}, {"probe": replace(PROBE, contacts=CONTACTS[::-1])}):
        found = seen(recorded(run, probes=probes), "contact_to_standstill_ms").value
        wanted = None if contact_ms is None else end_ns / MS - contact_ms
        assert found == (None if wanted is None else pytest.approx(wanted))
    edge = replace(PROBE, edges=(Edge(begin_ns, True), Edge(end_ns, True)))
    reaction = seen(recorded(run, probes={"probe": edge}), "reaction_ms").value
    assert reaction == pytest.approx((12_600_000 - begin_ns) / MS)
    latched = recorded(run, z={"plant": "z"})
    for at_ns, is_in in (
        (begin_ns - 1, False),
        (begin_ns, True),
        (end_ns, True),
        (end_ns + 1, False),
    ):
        records = {
            **latched.facts.axes,
            "Z": replace(latched.axes["Z"], latches=(Latch(at_ns, 1),)),
        }
        with_one = Observed(replace(latched.facts, axes=records), latched.series)
        if contact_ms is not None:
            assert (seen(with_one, "contact_to_latch_ms:Z").value is not None) is is_in


def test_of_two_probes_the_first_contact_and_edge_count_and_the_worse_knowledge() -> None:
    first = ProbeRecord(True, 5.0, (Contact(9 * MS, {"x": 5.018}),), (Edge(9_100_000, True),))
    probes = {"late": PROBE, "first": first}
    for names in (("late", "first"), ("first", "late")):
        wired = {name: probes[name] for name in names}
        observed = recorded(
            probes=wired,
            x={"signals": {"probe_1": "first"}},
            z={"signals": {"probe_1": "late", "probe_2": "none"}},
        )
        reaction = seen(observed, "reaction_ms")
        assert reaction.value == pytest.approx(3.5)
        assert reaction.uncertainty == pytest.approx(5e-6)
        assert seen(observed, "contact_to_standstill_ms").value == pytest.approx(21.6)
        assert seen(observed, "contact_mm:X").value == 5.018
    other = replace(RUN, inputs={"X": 2, "Z": 1})
    assert (
        recorded(other, probes=probes, x={"signals": {"probe_1": "first"}}).probes_of(other) == []
    )


@pytest.mark.parametrize(
    ("source", "wired", "names"),
    [
        ("PLC", ("of_plc",), ["of_plc"]),
        ("PLC_TIMESTAMP", ("of_plc",), ["of_plc"]),
        ("PLC", (), ["probe"]),
        ("DRIVE", ("of_plc",), ["probe"]),
        ("EXT_PROBE_WITH_DRIVE", ("of_plc",), ["probe"]),
    ],
)
def test_the_probes_of_a_run_are_those_of_its_source(
    source: str, wired: tuple[str, ...], names: list[str]
) -> None:
    run = replace(RUN, sources={"X": source, "Z": source})
    probes = {"probe": PROBE, "of_plc": NONE}
    task = PlcTaskRecord(MS, 0, 0, MS, 0, probes=wired)
    observed = recorded(run, probes=probes, plc_task=task)
    assert observed.probes_of(run) == [probes[name] for name in names]


def test_a_probe_that_touches_nothing_has_no_deflection() -> None:
    untouched = seen(recorded(), "probe_deflection_mm_max")
    assert (untouched.value, untouched.note) == (0.0, "the probe touched nothing")


def test_the_run_that_counts_is_the_last_of_its_axis() -> None:
    """Z, X with Z as slave of a stop, X: of an axis in none the last one."""
    stop = FixedStop({}, axes=("X", "Z"))
    runs = (
        MeasurementRun(("Z",), block="first"),
        MeasurementRun(("X",), block="second", fixed_stop=stop),
        MeasurementRun(("X",), block="third"),
    )
    observed = Observed(facts(axes={"X": axis("X"), "Z": axis("Z")}, runs=runs), kept(table()))
    found = [observed.last_run(name) for name in ("Z", "X", None, "Y")]
    assert [run and run.block for run in found] == ["second", "third", "third", "third"]
    until = observed.until_run(0)
    assert [run.block for run in until.facts.runs] == ["first"]


@pytest.mark.parametrize(
    ("metric", "named", "axes"),
    [
        ("latch_mm", None, ["X"]),  # of the last run
        ("stop_force_n_max", None, ["Z", "X"]),  # of every run
        ("latch_mm", "Y", ["Y"]),
        ("lag_mm_max", None, ["X", "Y", "Z"]),  # of no run
    ],
)
def test_a_metric_is_about_the_axes_of_what_it_judges(
    metric: str, named: str | None, axes: list[str]
) -> None:
    runs = (MeasurementRun(("Z",)), MeasurementRun(("X",)))
    records = {name: axis(name) for name in "XYZ"}
    observed = Observed(facts(axes=records, runs=runs), kept(table()))
    assert observed.about(known_metrics()[metric], named) == axes


REAL = RealTime(1000.0, 100.0, 1, 0, None, None, (), (), 0, 0.0, 0, 0.0, 0)


@pytest.mark.parametrize(
    ("needs", "outside", "real_time", "words"),
    [
        ("bus", "", None, ""),
        ("bus", "XZ", None, ""),
        ("bus", "", REAL, "a bus is real: what happens on its wire is not seen here"),
        ("plant", "", REAL, ""),
        ("plant", "X", REAL, "the drive of axis X is real: no plant gives the truth"),
        ("plant", "XZ", None, "the drive of axis X Z is real: no plant gives the truth"),
        ("", "XZ", REAL, ""),
    ],
)
def test_what_is_real_hides_what_needs_it(
    needs: str, outside: str, real_time: RealTime | None, words: str
) -> None:
    metric = replace(known_metrics()["latch_mm"], needs=needs)
    records = {name: axis(name, is_outside=name in outside) for name in "XZ"}
    observed = Observed(facts(axes=records, runs=(RUN,), real_time=real_time), kept(table()))
    assert observed.hides(metric, None) == words
    assert observed.hides(metric, "Z") == (
        words if needs == "bus" or "Z" in outside else ""
    ).replace("X Z", "Z")


def test_marks_are_where_and_what_happened() -> None:
    deep = Deflection(1.5, 0.1, 15 * MS, "probe: 1.5 mm of 1 mm")
    probe = replace(PROBE, contacts=CONTACTS[1:2], edges=EDGES[1:], edge_uncertainty_ns=2500.0,
                    deflections=(deep, Deflection(0.1, 0.0)))  # fmt: skip
    observed = recorded(probes={"probe": probe})
    found = [(e.time_ns, e.kind, e.label, e.axis) for e in latch_events(observed)]
    assert found == [
        (10_400_000, "contact", "probe: contact", None),
        (10_500_000, "edge", "probe: rising edge, known to 2.5 us", None),
        (20 * MS, "edge", "probe: falling edge, known to 2.5 us", None),
        (15 * MS, "fault", "probe: 1.5 mm of 1 mm", None),
        (4_999_999, "latch", "Z: latch of probe 1", "Z"),
        (10_600_000, "latch", "Z: latch of probe 1", "Z"),
        (20 * MS, "latch", "Z: latch of probe 2", "Z"),
        (12 * MS, "pdo", "SYNC that sampled the latch status", None),
        (12_600_000, "brake", "cycle that brakes", None),
        (30_600_000, "standstill", "measurement run ended", None),
    ]


@pytest.mark.parametrize(
    ("changes", "labels"),
    [
        ({"goes_on": True}, ["SYNC that sampled the latch status", "cycle that sees the signal"]),
        (
            {"sources": {"X": "DRIVE", "Z": "PLC"}},
            ["SYNC before the cycle that sees the signal of the PLC", "cycle that brakes"],
        ),
        ({"signal_ns": None}, []),
        ({"fixed_stop": FixedStop({}, detected_ns=12_600_000)}, []),
    ],
)
def test_a_signal_is_marked_by_who_sees_it(changes: Mapping[str, Any], labels: list[str]) -> None:
    run = replace(RUN, **changes)
    found = latch_events(recorded(run, probes={"probe": NONE}))
    assert [e.label for e in found if e.kind in ("pdo", "brake")] == labels
    ended = latch_events(recorded(replace(run, end_ns=None), probes={"probe": NONE}))
    assert "standstill" in {e.kind for e in found}
    assert "standstill" not in {e.kind for e in ended}
