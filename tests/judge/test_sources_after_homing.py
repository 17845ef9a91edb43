"""Positions at the signal of a PLC beside the truth of the plant: zero of the machine, doubts.

Homing (G74) lets the drive count from another place: what a machine reports plus that zero is the
place in the plant. As `test_signal_at_plc.py`: Z goes down with 10 mm/s, an edge at 10.28 ms is in
the exchange at 10.3 ms, and the cycle at 10.6 ms gives the position of the SYNC at 10.048 ms.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

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

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.signal_sources import AT_SIGNAL, STAMPED
from axisrig.kernel.time.clock import MS, US

EDGE_NS = 10_280 * US
SOURCES = (*AT_SIGNAL, STAMPED)


def touched(
    source: str = "PLC",
    of_axis: Mapping[str, Any] | None = None,
    of_run: Mapping[str, Any] | None = None,
    of_facts: Mapping[str, Any] | None = None,
    zero_mm: float = 0.0,
    off_um: float = 0.0,
    **of_task: Any,
) -> Observed:
    """zero_mm: what the published value counts from. off_um: by how much it is wrong."""
    at_ns = EDGE_NS if source == STAMPED else 10 * MS + SYNC_NS
    task = replace(TASK, **of_task)
    observed = left([(EDGE_NS, True)], 10 * MS + CYCLE_NS, at_ns, task=task, source=source)
    axis = replace(observed.axes["Z"], **(of_axis or {}))
    value = {"latched_mm": {"Z": place_mm(at_ns) - zero_mm + off_um * 1e-3}, "begin_ns": 2 * MS}
    run = replace(observed.facts.runs[0], **{**value, **(of_run or {})})
    changed = {"axes": {"Z": axis}, "runs": (run,), **(of_facts or {})}
    return Observed(replace(observed.facts, **changed), observed.series)


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("origin_mm", [7.5, -31.0])
@pytest.mark.parametrize("off_um", [0.0, 3.0, -2.0])
@pytest.mark.parametrize(
    ("homed_ms", "is_shifted"), [((), False), ((1,), True), ((2,), True), ((1, 2), True),
                                 ((31,), False)],
)  # fmt: skip
def test_a_value_at_the_plc_counts_from_where_the_axis_was_homed(
    source: str, origin_mm: float, off_um: float, homed_ms: tuple[int, ...], is_shifted: bool
) -> None:
    """Before the run or as it begins at 2 ms; what comes after its end at 30 ms is another zero."""
    observed = touched(
        source,
        {"homed_ns": tuple(ms * MS for ms in homed_ms), "origin_mm": origin_mm},
        zero_mm=origin_mm if is_shifted else 0.0,
        off_um=off_um,
    )
    late, error = found(observed)
    assert late.value == 0.0
    assert error.value == pytest.approx(off_um, abs=1e-6)


@pytest.mark.parametrize("source", SOURCES)
def test_between_two_homings_a_value_at_the_plc_has_no_truth(source: str) -> None:
    homed = {"homed_ns": (MS, 31 * MS), "origin_mm": 7.5}
    late, error = found(touched(source, homed))
    assert late.value == 0.0  # who sees the signal asks for no place
    assert (error.value, error.note) == (None, "axis Z was homed before and after the run")


@pytest.mark.parametrize(
    ("source", "jitter_ns", "uncertainty_um"),
    [("PLC", 1000, 0.0), ("PLC_FIRST_EVENT", 1000, 0.0), (STAMPED, 0, 0.0), (STAMPED, 1000, 0.01),
     (STAMPED, 4000, 0.04)],
)  # fmt: skip
def test_the_jitter_of_a_stamp_is_of_stamps_alone(
    source: str, jitter_ns: int, uncertainty_um: float
) -> None:
    """10 mm/s are 0.01 um in each us; the edge itself is known to 1 ns."""
    error = found(touched(source, stamp_jitter_ns=jitter_ns))[1]
    assert error.uncertainty == pytest.approx(uncertainty_um, abs=1.1e-9 * -SPEED_MM_S * 1e3)
    assert ("jitter of the stamp" in error.note) is (uncertainty_um > 0.0)


@pytest.mark.parametrize(
    ("doubts", "doubt_um"), [({"Z": 0.25}, 250.0), ({"X": 0.25}, 0.0), ({}, 0.0), (None, 0.0),
                             ({"X": 9.0, "Z": 0.002}, 2.0)],
)  # fmt: skip
def test_what_is_unproved_is_of_its_axis(doubts: dict[str, float] | None, doubt_um: float) -> None:
    error = found(touched(of_run={"doubt_mm": doubts}))[1]
    assert error.uncertainty == pytest.approx(doubt_um, abs=1e-6)
    assert ("unproved" in error.note) is (doubt_um > 0.0)


@pytest.mark.parametrize(
    ("changes", "late_note", "error_note"),
    [
        ({"source": "DRIVE"}, None, "the signal of axis Z is at no terminal of a PLC"),
        ({"of_facts": {"plc_task": None}}, "no probe is wired to the PLC",
         "the signal of axis Z is at no terminal of a PLC"),
        ({"probes": ()}, "no probe is wired to the PLC",
         "the signal of axis Z is at no terminal of a PLC"),
        ({"of_run": {"latched_mm": {}}}, "", "no measured value of axis Z"),
        ({"of_run": {"latched_mm": {"X": 1.0}}}, "", "no measured value of axis Z"),
        ({"of_run": {"begin_ns": 11 * MS}}, "no edge was seen in the measurement run",
         "no measured value of axis Z"),
        ({"of_run": {"end_ns": 10 * MS}}, "no edge was seen in the measurement run",
         "no measured value of axis Z"),
        ({"of_run": {"signal_ns": None}}, "no edge was seen in the measurement run", ""),
    ],
)  # fmt: skip
def test_what_a_signal_at_the_plc_does_not_have_says_why(
    changes: dict[str, Any], late_note: str | None, error_note: str
) -> None:
    """An empty note: there is a value all the same."""
    late, error = found(touched(**changes))
    if late_note is not None:
        assert (late.value is None, late.note) == (bool(late_note), late_note)
    assert (error.value is None, error.note) == (bool(error_note), error_note)


@pytest.mark.parametrize("cycles", [-2, -1, 0, 1, 3])
def test_a_signal_is_late_by_whole_cycles_and_early_ones_count_below_zero(cycles: int) -> None:
    signal_ns = 10 * MS + CYCLE_NS + cycles * MS
    late, error = found(touched(of_run={"signal_ns": signal_ns}))
    assert (late.value, late.uncertainty, late.note) == (cycles, 0.0, "")
    assert error.value == pytest.approx(0.0, abs=1e-6)
