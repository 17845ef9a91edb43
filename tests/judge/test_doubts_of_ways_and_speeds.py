"""Speeds at a contact and places of a signal: of which axis, at which instant, how well known."""

from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge import stop_recordings as stops
from tests.judge.test_signal_at_plc import CYCLE_NS, TASK, found, left, place_mm
from tests.judge.test_touches import PROBE, RUN, recorded, seen
from tests.judge.test_two_axes_at_stops import recorded as two_axes
from tests.judge.test_ways_of_a_signal import uneven
from tests.recordings import kept

from axisrig.bench.judge.observed.motion import INSIDE, state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS, US

CONTACT_ROW = int(stops.CONTACT_MS)
SINCE_MS = stops.CONTACT_MS - CONTACT_ROW


def braking(of: Observed, axis: str, mm_s2: float) -> Observed:
    """An axis changes its speed evenly from the SYNC before the contact on."""
    table = of.series.table()
    since_s = np.maximum(stops.K - CONTACT_ROW, 0) * 1e-3
    for name, more in (("truth_mm", 0.5 * mm_s2 * since_s**2), ("velocity_mm_s", mm_s2 * since_s)):
        place = table.column_names.index(f"{axis}.{name}")
        values = pa.array(table.column(place).to_numpy() + more)
        table = table.set_column(place, f"{axis}.{name}", values)
    return Observed(of.facts, kept(table))


@pytest.mark.parametrize(("first", "other"), [("Z", "X"), ("X", "Z")])
@pytest.mark.parametrize("mm_s2", [-1000.0, 800.0])
def test_an_axis_beside_the_one_that_meets_its_stop_has_the_speed_of_that_instant(
    first: str, other: str, mm_s2: float
) -> None:
    """0.3 ms after the SYNC; the one that meets its stop goes on as it did up to the SYNC."""
    of = two_axes({first: 0, other: 7})
    speed = seen(braking(of, other, mm_s2), f"contact_velocity_mm_s:{other}")
    assert speed.value == pytest.approx(stops.V_MM_S + mm_s2 * SINCE_MS * 1e-3, abs=1e-6)
    of_first = seen(braking(of, first, mm_s2), f"contact_velocity_mm_s:{first}")
    assert of_first.value == pytest.approx(stops.V_MM_S, abs=1e-6)


@pytest.mark.parametrize("by_mm_s", [0.0, 0.5, 3.0])
@pytest.mark.parametrize("axis", ["X", "Z"])
def test_a_speed_at_a_contact_is_known_as_the_motion_knows_speeds(
    axis: str, by_mm_s: float
) -> None:
    of = uneven(recorded(), axis, by_mm_s)
    speed, there = seen(of, f"contact_velocity_mm_s:{axis}"), state_at(of, axis, 10_400_000)
    assert there is not None
    assert speed.uncertainty == pytest.approx(there.doubt_mm_s)
    assert (there.doubt_mm_s > 10.0 * there.doubt_mm) is (by_mm_s > 0.0)
    assert speed.note.endswith(INSIDE)
    assert speed.note.startswith("signed: ") is (axis == "Z")


@pytest.mark.parametrize("by_mm_s", [0.5, 3.0])
def test_an_overtravel_has_the_rest_the_way_inside_a_step_and_the_place_of_its_contact(
    by_mm_s: float,
) -> None:
    """Lag and v/Kv at the end, what is between two SYNCs, and the contact known to 3 us."""
    known = {"probe": replace(PROBE, edge_uncertainty_ns=3000.0)}
    even, exact = (seen(recorded(probes=p), "overtravel_mm:Z") for p in (known, None))
    way_mm = seen(recorded(probes=known), "contact_mm:Z").uncertainty
    assert way_mm == pytest.approx(10.0 * 3e-6)
    assert even.uncertainty - exact.uncertainty == pytest.approx(way_mm)
    swings = seen(uneven(recorded(), "Z", by_mm_s), "overtravel_mm:Z")
    rest_mm = seen(uneven(recorded(), "Z", by_mm_s), "standstill_mm:Z").uncertainty
    assert swings.uncertainty > rest_mm


@pytest.mark.parametrize("keeps_last", [False, True])
@pytest.mark.parametrize("edge_us", [9_000, 10_200, 10_299])
def test_a_stamp_is_of_an_edge_before_the_exchange_that_brings_it(
    edge_us: int, keeps_last: bool
) -> None:
    """Exchanged at 10.3 ms; it bounces once more before the CNC looks at 10.6 ms."""
    edges = [(edge_us * US, True), (10_350 * US, False), (10_400 * US, True)]
    task = replace(TASK, keeps_last_stamp=keeps_last)
    of = left(edges, 10 * MS + CYCLE_NS, edge_us * US, task=task, source="PLC_TIMESTAMP",
              known_ns=0.0)  # fmt: skip
    late, error = found(of)
    assert (late.value, error.value) == (0.0, pytest.approx(0.0, abs=1e-6))


def late_unrest(of: Observed, first: int) -> Observed:
    """The speed swings from a row on."""
    table, name = of.series.table(), "Z.velocity_mm_s"
    values = table[name].to_numpy().copy()
    rows = np.arange(len(values))
    values += np.where(rows >= first, 2.0 * (-1.0) ** rows, 0.0)
    table = table.set_column(table.column_names.index(name), name, pa.array(values))
    return Observed(of.facts, Series(table))


@pytest.mark.parametrize("first", [0, 14, 39])
def test_of_several_ways_the_place_that_is_known_worst_counts(first: int) -> None:
    """The edge is at 10.5 ms, or 5 ms before or after it; from a row on the motion is uneven."""
    at_ns, known_ns = 10_500 * US, 5 * MS
    of: Any = left([(at_ns, True)], 12 * MS + CYCLE_NS, at_ns, source="PLC_TIMESTAMP",
                   known_ns=float(known_ns))  # fmt: skip
    of = late_unrest(of, first)
    ways = (at_ns, at_ns + 1 - known_ns, at_ns + known_ns)
    states = [state_at(of, "Z", ns) for ns in ways]
    errors = [place_mm(at_ns) - state.position_mm for state in states if state is not None]
    doubts = [state.doubt_mm for state in states if state is not None]
    _, error = found(of)
    apart = max(abs(each - errors[0]) for each in errors)
    assert error.uncertainty == pytest.approx((apart + max(doubts)) * 1e3)
    assert (doubts[2] > 0.0) is (first < 39)
    assert (doubts[0] > 0.0) is (first == 0)


@pytest.mark.parametrize(("end_ms", "row"), [(30.6, 30), (20.0, 20), (12.7, 12)])
def test_the_way_of_a_stop_ends_with_its_run(end_ms: float, row: int) -> None:
    """Set positions are the squares of their rows, the last one before it brakes is of row 13."""
    run = replace(RUN, end_ns=round(end_ms * MS))
    found_ = seen(recorded(run), "stop_way_mm:Z")
    assert found_.value == abs(row**2 - 13**2)


@pytest.mark.parametrize("lag_mm", [0.02, -0.03])
def test_what_a_drive_lags_by_is_left_to_go_in_either_direction(lag_mm: float) -> None:
    columns = {"Z.drive_lag_mm": np.full(40, lag_mm), "Z.velocity_mm_s": np.full(40, 0.0)}
    assert seen(recorded(columns=columns), "standstill_mm:Z").uncertainty == pytest.approx(
        abs(lag_mm)
    )
