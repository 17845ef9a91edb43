"""A signal at a PLC that may have been seen in several ways, and the place that belongs to it.

As `test_signal_at_plc.py`: Z goes down with 10 mm/s, exchange and PLC every 2 ms at 300 us.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.test_signal_at_plc import (
    CYCLE_NS,
    SPEED_MM_S,
    SYNC_NS,
    TASK,
    found,
    left,
    place_mm,
)
from tests.judge.test_touches import PROBE, RUN, recorded, seen

from axisrig.bench.judge.latch.sources import UNSEEN
from axisrig.bench.judge.latch.truth import true_state
from axisrig.bench.judge.observed.motion import state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS, US


@pytest.mark.parametrize(
    ("plc_us", "terminal_us", "sync_ms"),
    [
        (300, 300, 10),  # seen at 10.3, by the CNC at 10.6
        (1500, 300, 11),  # exchanged at 10.3, seen at 11.5
        (1700, 300, 12),  # 11.7: the cycle at 12.6
        (300, 1500, 12),  # exchanged at 11.5, seen at 12.3
        (1900, 1500, 12),
    ],
)
def test_terminal_and_plc_have_their_own_phases(
    plc_us: int, terminal_us: int, sync_ms: int
) -> None:
    """The level is there at 10.28 ms."""
    task = replace(TASK, offset_ns=plc_us * US, terminal_offset_ns=terminal_us * US)
    at_ns = sync_ms * MS
    late, error = found(left([(10_280 * US, True)], at_ns + CYCLE_NS, at_ns + SYNC_NS, task=task))
    assert (late.value, late.uncertainty) == (0.0, 0.0)
    assert error.value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("of_z", "of_x", "value"),
    [
        ("PLC", "PLC_EXT_LATCH_CONTROL", None),
        ("PLC_EXT_LATCH_CONTROL", "PLC", 0.0),
        ("PLC_EXT_LATCH_CONTROL", "PLC_EXT_LATCH_CONTROL", 0.0),
    ],
)
def test_each_axis_has_its_own_source(of_z: str, of_x: str, value: float | None) -> None:
    """On for 0.6 ms only, a CNC each 3 ms: hardware that keeps the level is that of its axis."""
    task = replace(TASK, period_ns=MS // 2, offset_ns=0, terminal_ns=MS // 2, terminal_offset_ns=0)
    edges = [(9_900 * US, True), (10_500 * US - 1, False)]
    of = left(edges, 12 * MS + CYCLE_NS, 12 * MS + SYNC_NS, task=task, source=of_z,
              timing=Timing(3 * MS, CYCLE_NS, 0))  # fmt: skip
    (run,) = of.facts.runs
    run = replace(run, sources={"Z": of_z, "X": of_x})
    late, error = found(Observed(replace(of.facts, runs=(run,)), of.series))
    assert (late.value, error.value) == (value, value if value is None else pytest.approx(value))


@pytest.mark.parametrize(
    ("known_ns", "uncertainty"), [(0.0, 0.0), (0.1, 2.0), (0.5, 2.0), (1.0, 2.0), (1.5, 2.0)]
)
def test_a_part_of_a_nanosecond_may_be_before_or_behind(
    known_ns: float, uncertainty: float
) -> None:
    """An edge at the very instant of the exchange at 10.3 ms."""
    observed = left([(10_300 * US, True)], 10 * MS + CYCLE_NS, 10 * MS + SYNC_NS, known_ns=known_ns)
    late, error = found(observed)
    assert (late.value, late.uncertainty) == (0.0, uncertainty)
    assert error.uncertainty == pytest.approx(-SPEED_MM_S * uncertainty, abs=1e-6)


@pytest.mark.parametrize(
    ("known_us", "uncertainty"), [(900, 0.0), (1100, 2.0), (2900, 2.0), (3100, 4.0)]
)
def test_ways_before_and_behind_are_as_far_as_the_farther_one(
    known_us: int, uncertainty: float
) -> None:
    """An edge at 13.3 ms, in the middle between two exchanges: earlier or later by cycles."""
    observed = left([(13_300 * US, True)], 14 * MS + CYCLE_NS, 14 * MS + SYNC_NS,
                    known_ns=known_us * 1e3)  # fmt: skip
    late, error = found(observed)
    assert (late.value, late.uncertainty) == (0.0, uncertainty)
    assert error.uncertainty == pytest.approx(-SPEED_MM_S * uncertainty, abs=1e-6)


@pytest.mark.parametrize(("edge_us", "is_known"), [(38_700, True), (38_900, False)])
def test_a_place_is_known_where_each_way_is_in_the_recording(edge_us: int, is_known: bool) -> None:
    """The stamp may be 0.2 ms later; the last row is at 39.048 ms."""
    at_ns = edge_us * US
    of = left([(at_ns, True)], 39 * MS, at_ns, source="PLC_TIMESTAMP", known_ns=200e3)
    (run,) = of.facts.runs
    of = Observed(replace(of.facts, runs=(replace(run, end_ns=39 * MS),)), of.series)
    _, error = found(of)
    if is_known:
        assert error.value == pytest.approx(0.0, abs=1e-6)
        assert error.uncertainty == pytest.approx(2.0, rel=1e-6)
    else:
        assert (error.value, error.note) == (None, UNSEEN)


# Motion that is not even: what lies between two SYNCs is in doubt


def uneven(of: Observed, axis: str = "Z", by_mm_s: float = 0.5) -> Observed:
    """The speed swings from SYNC to SYNC."""
    table, name = of.series.table(), f"{axis}.velocity_mm_s"
    values = table[name].to_numpy().copy()
    values += by_mm_s * (-1.0) ** np.arange(len(values))
    table = table.set_column(table.column_names.index(name), name, pa.array(values))
    return Observed(of.facts, Series(table))


def test_what_is_apart_and_what_lies_between_add_up() -> None:
    """An edge known to 20 us, at 10 mm/s 0.2 um either way."""
    at_ns = 10_500 * US
    doubts = []
    for known_ns in (0.0, 20_000.0):
        of = left([(at_ns, True)], 12 * MS + CYCLE_NS, at_ns, source="PLC_TIMESTAMP",
                  known_ns=known_ns)  # fmt: skip
        error = found(uneven(of))[1]
        doubts.append(error.uncertainty)
        between = state_at(uneven(of), "Z", at_ns)
        assert between is not None
        assert error.uncertainty >= between.doubt_mm * 1e3 > 0.0
    speed = state_at(uneven(of), "Z", at_ns)
    assert speed is not None
    assert doubts[1] - doubts[0] == pytest.approx(20e-3 * abs(speed.speed_mm_s), rel=0.02)


@pytest.mark.parametrize("beside_ns", [0, 400, -400, 1000])
def test_a_noted_place_is_in_doubt_by_the_speed_since_it_alone(beside_ns: int) -> None:
    at_ns = 10_500 * US
    of = uneven(left([(at_ns, True)], 12 * MS + CYCLE_NS, at_ns, source="PLC_TIMESTAMP"))
    noted_mm = place_mm(at_ns) + 0.001
    row = EdgeTruth("probe", "Z", True, at_ns, None, None, at_ns, noted_mm, noted_mm)
    noted = Observed(replace(of.facts, edges=(row,)), of.series)
    between, found_ = (
        state_at(of, "Z", at_ns + beside_ns),
        true_state(noted, "Z", at_ns + beside_ns),
    )
    assert between is not None
    assert found_ is not None
    assert between.doubt_mm_s > 0.0
    assert found_.doubt_mm == pytest.approx(between.doubt_mm_s * abs(beside_ns) * 1e-9)
    assert found_.position_mm == pytest.approx(noted_mm + between.speed_mm_s * beside_ns * 1e-9)
    assert true_state(noted, "Z", at_ns + 1001) == state_at(of, "Z", at_ns + 1001)


@pytest.mark.parametrize(
    ("metric", "axis", "at_ns"),
    [
        ("latch_mm", "Z", 10_500_000), ("latch_mm", "X", 10_500_000),
        ("contact_mm", "Z", 10_400_000), ("contact_mm", "X", 10_400_000),
    ],
)  # fmt: skip
def test_the_way_in_the_doubt_of_an_instant_has_that_of_the_speed(
    metric: str, axis: str, at_ns: int
) -> None:
    """An event known to 3 us, at the most that the speed may be there."""
    known_ns, by_mm_s = 3000.0, 0.5
    probe = {"probe": replace(PROBE, edge_uncertainty_ns=known_ns)}
    run = replace(RUN, latched_mm={"Z": 99.8965, "X": 5.021})
    of: Any = uneven(recorded(run, probes=probe), axis, by_mm_s)
    there = state_at(of, axis, at_ns)
    assert there is not None
    assert there.doubt_mm_s > 0.0
    expected = (abs(there.speed_mm_s) + there.doubt_mm_s) * known_ns * 1e-9
    assert seen(of, f"{metric}:{axis}").uncertainty == pytest.approx(expected)
