"""What a budget takes out of one run: its error, the motion around the contact, where axes were."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, Contact, Edge, ProbeRecord
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.tools.budget.observed_run import METRICS, see
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

ROWS = 90
CONTACT_NS = 70 * MS + 250_000
PLACES_MM = {"Z": lambda ms: 12.0 - 0.1 * ms, "C": lambda ms: -40.0 + 0.5 * ms,
             "X": lambda ms: 900.0 + 0.0 * ms}  # fmt: skip
"""Z measures with 100 mm/s downwards; C has the same drive, X another one."""


def recorded(edge_ns: int | None = CONTACT_NS + 120_000) -> Facts:
    """A touch in the second run of Z; its probe has touched once before."""
    edges = () if edge_ns is None else (Edge(edge_ns, True),)
    contacts = (Contact(20 * MS, {"z": 10.0}), Contact(CONTACT_NS, {"z": 4.975}))
    runs = tuple(
        MeasurementRun(("Z",), begin_ns=begin, end_ns=end, inputs={"Z": 1})
        for begin, end in ((10 * MS, 30 * MS), (60 * MS, 85 * MS))
    )
    return facts(
        axes={name: AxisRecord("can1", n, 1.0, plant=name.lower(), signals={"probe_1": "probe"})
              for n, name in enumerate(PLACES_MM, 1)},
        probes={"probe": ProbeRecord(True, 1.0, contacts=contacts, edges=edges)},
        runs=runs, end_ns=ROWS * MS, sim_ns=ROWS * MS,
    )  # fmt: skip


def settings() -> Any:
    drives = {"Z": "servo", "C": "servo", "X": "other"}
    axes = {
        name: SimpleNamespace(drive=drive, plant=name.lower(), probe_1="probe")
        for name, drive in drives.items()
    }
    plants = {name.lower(): SimpleNamespace(start={}, wire={}) for name in axes}
    plants["probe"] = SimpleNamespace(start={}, wire={"z": "z"})
    return SimpleNamespace(rig=SimpleNamespace(axis=axes, plant=plants), start={})


def result(left: Facts | None, **values: float | None) -> CaseResult:
    """A run with the values of its metrics; what is not named is not there."""
    ms = np.arange(ROWS, dtype=np.float64)
    columns: dict[str, Any] = {"time_ns": np.arange(ROWS, dtype=np.int64) * MS}
    for name, place_mm in PLACES_MM.items():
        columns[f"{name}.truth_mm"] = place_mm(ms)
        columns[f"{name}.velocity_mm_s"] = np.gradient(place_mm(ms), 1e-3)
    checks = [
        judge(parse_check(f"{name}:Z", "-1e9 .. 1e9", ""), values.get(name), 0.0, "no latch")
        for name in METRICS
    ]
    case: Any = SimpleNamespace(run="p-a", inputs={"plc:V.E.FEED": "600"})
    series = None if left is None else kept(pa.table(columns))
    return CaseResult(case, Verdict.PASS, checks, facts=left, series=series)


ERROR, VELOCITY, LATCH, SOURCE = METRICS
LATCHED = {ERROR: -30.0, VELOCITY: -100.0, LATCH: 0.3}


def test_the_motion_is_kept_from_50_syncs_before_the_contact_on() -> None:
    """v = -100 mm/s: 12 um in the 0.12 ms to the edge, 30 um in the 0.3 ms to the latch."""
    seen = see(result(recorded(), **LATCHED), "Z", settings())
    assert (seen.error_um, seen.velocity_mm_s) == (-30.0, -100.0)
    assert (seen.latch_ms, seen.source_um) == (0.3, None)
    track = seen.track
    assert track is not None
    assert list(track.times_ns) == [row * MS for row in range(20, ROWS)]
    assert track.position_mm[0] == pytest.approx(10.0)
    assert (track.contact_ns, track.touches) == (CONTACT_NS, 2)
    assert track.edge_ms == pytest.approx(0.12)
    assert seen.moved_um(0.0, track.edge_ms) == pytest.approx(-12.0)
    assert seen.delayed_um == pytest.approx(-30.0)
    assert (seen.value_ms, seen.sampled_ms) == (pytest.approx(0.3), None)
    assert seen.per_length == -1.0


@pytest.mark.parametrize("end_ns", [20 * MS, 200_000])
def test_the_motion_of_a_touch_soon_after_the_begin_is_kept_from_the_begin_on(end_ns: int) -> None:
    """Where there are no 50 SYNCs before the contact: at 20 ms, or within the first one."""
    left = recorded()
    first = MeasurementRun(("Z",), begin_ns=0, end_ns=30 * MS, inputs={"Z": 1})
    probe = ProbeRecord(
        True, 1.0, contacts=(Contact(end_ns, {"z": 10.0}),), edges=(Edge(end_ns + 50_000, True),)
    )
    early = facts(**{**vars(left), "runs": (first,), "probes": {"probe": probe}})
    track = see(result(early, **LATCHED), "Z", settings()).track
    assert track is not None
    assert list(track.times_ns) == [row * MS for row in range(ROWS)]
    assert (track.contact_ns, track.touches) == (end_ns, 1)
    assert track.edge_ms == pytest.approx(0.05)


def test_an_edge_that_nobody_saw_is_at_the_contact() -> None:
    seen = see(result(recorded(None), **LATCHED), "Z", settings())
    assert seen.track is not None
    assert seen.track.edge_ms == 0.0


def test_how_far_a_drive_must_reach_is_that_of_every_axis_that_has_it() -> None:
    """Z goes from 12 mm to 3.1, C with the same drive begins at -40; X at 900 has another one."""
    seen = see(result(recorded(), **LATCHED), "Z", settings())
    assert seen.farthest_mm == pytest.approx(40.0)
    alone = settings()
    alone.rig.axis["C"].drive = "other"
    assert see(result(recorded(), **LATCHED), "Z", alone).farthest_mm == pytest.approx(12.0)


def test_without_a_recording_or_a_contact_there_are_the_numbers_alone() -> None:
    plain = see(result(None, **LATCHED, source_error_um=4.0), "Z", settings())
    assert (plain.track, plain.source_um, plain.farthest_mm) == (None, 4.0, 0.0)
    assert plain.way_um == -34.0
    assert plain.moved_um(0.0, 0.3) == pytest.approx(-30.0)
    left = recorded()
    empty = ProbeRecord(True, 1.0)
    nowhere = facts(**{**vars(left), "probes": {"probe": empty}})
    assert see(result(nowhere, **LATCHED), "Z", settings()).track is None


@pytest.mark.parametrize("lacking", [ERROR, VELOCITY])
def test_a_run_without_a_measured_value_has_no_budget(lacking: str) -> None:
    values = {name: value for name, value in LATCHED.items() if name != lacking}
    with pytest.raises(UserError, match=f"no {lacking} of p-a: no latch") as caught:
        see(result(recorded(), **values), "Z", settings())
    assert caught.value.value == "plc:V.E.FEED=600"
