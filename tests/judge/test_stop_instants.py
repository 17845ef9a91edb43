"""Which row of a recording an instant of a run to a fixed stop is: the last at or before it.

As `stop_recordings.py`: from the contact at 140.3 ms the axis goes 10 mm/s into its stop for 10 ms,
the demand goes on until 220 ms; a SYNC each ms.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEEP_MM,
    DETECTED_NS,
    FIRST,
    FORCE_N,
    K_N_M,
    LAG_MM,
    LATCHED_MM,
    PRESSED_N,
    ROWS,
    RUN,
    STOP,
    STOP_MM,
    V_MM_S,
    K,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.metrics import BESIDE
from axisrig.bench.judge.fixed_stop.run import stop_runs
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.time.clock import MS, US

V = V_MM_S * 1e-3
"""mm in a ms."""


def found_at(at_ns: int) -> MeasurementRun:
    return replace(RUN, fixed_stop=replace(STOP, detected_ns=at_ns), signal_ns=at_ns)


def relaxed_at(at_ns: int) -> MeasurementRun:
    return replace(RUN, fixed_stop=replace(STOP, relax_end_ns=at_ns))


def ended_at(at_ns: int) -> MeasurementRun:
    return replace(RUN, end_ns=at_ns)


def deep_mm(at_ms: int) -> float:
    return V * (at_ms - CONTACT_MS)


@pytest.mark.parametrize(
    ("metric", "run_at", "at_ms", "value_at"),
    [
        ("stop_force_n", found_at, 145, lambda ms: deep_mm(ms) * 1e-3 * K_N_M),
        ("stop_force_end_n", ended_at, 145, lambda ms: deep_mm(ms) * 1e-3 * K_N_M),
        ("latch_force_error_um", found_at, 145,
         lambda ms: (LATCHED_MM - STOP_MM - deep_mm(ms)) * 1e3),
        ("relax_lag_mm", relaxed_at, 145, lambda ms: LAG_MM),
        ("relax_lag_mm", relaxed_at, 160, lambda ms: V * (ms - FIRST) - STOP_MM - DEEP_MM),
        ("command_overtravel_mm", ended_at, 210, lambda ms: V * (ms - FIRST) - LATCHED_MM),
    ],
)  # fmt: skip
@pytest.mark.parametrize("after_ns", [-1, 0, 1, MS - 1])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_instant_is_the_row_of_its_sync_and_of_all_until_the_next_one(
    metric: str,
    run_at: Callable[[int], MeasurementRun],
    at_ms: int,
    value_at: Callable[[int], float],
    after_ns: int,
    side: float,
) -> None:
    """A nanosecond before a SYNC it is the row before."""
    value = value_at(at_ms if after_ns >= 0 else at_ms - 1)
    found = seen(recorded(side, run=run_at(at_ms * MS + after_ns)), metric)
    is_signed = metric in ("latch_force_error_um", "relax_lag_mm")
    assert found.value == pytest.approx(side * value if is_signed else value, abs=1e-6)


@pytest.mark.parametrize(
    ("at_ns", "row"),
    [(-5, 0), (0, 0), (MS - 1, 0), (MS, 1), (7 * MS, 7), (7.5 * MS, 7),
     ((ROWS - 1) * MS, ROWS - 1), (9 * ROWS * MS, ROWS - 1)],
)  # fmt: skip
def test_what_is_outside_the_recording_has_its_first_or_last_row(at_ns: float, row: int) -> None:
    (run,) = stop_runs(recorded())
    assert run.row_at(at_ns) == row


@pytest.mark.parametrize(
    ("begin_ns", "end_ns", "rows"),
    [
        (10 * MS, 300 * MS, (10, 301)),
        (10 * MS + 1, 300 * MS - 1, (11, 300)),
        (10 * MS - 1, 300 * MS + 1, (10, 301)),
        (7 * MS, 7 * MS, (7, 8)),
        (7 * MS + 1, 7 * MS + 2, (8, 8)),  # between two SYNCs: no row at all
        (399 * MS, 500 * MS, (399, 400)),
        (400 * MS, 500 * MS, (400, 400)),
    ],
)
def test_a_run_has_the_rows_from_its_begin_to_its_end_with_both(
    begin_ns: int, end_ns: int, rows: tuple[int, int]
) -> None:
    (run,) = stop_runs(recorded(run=replace(RUN, begin_ns=begin_ns, end_ns=end_ns)))
    assert (run.rows.start, run.rows.stop) == rows


HIT_N = 2 * FORCE_N


def hit_at(row: int) -> dict[str, Any]:
    """The force that presses, and twice of it in one row."""
    force = np.where(row == K, HIT_N, PRESSED_N)
    return {"stop_force_n": force, "stop_force_peak_n": force}


@pytest.mark.parametrize(
    ("begin_ns", "end_ns", "row", "is_in", "is_beside"),
    [
        (10 * MS, 300 * MS, 10, True, False),
        (10 * MS, 300 * MS, 300, True, False),
        (10 * MS, 300 * MS, 9, False, True),
        (10 * MS, 300 * MS, 301, False, True),
        (10 * MS, 300 * MS, 8, False, False),
        (10 * MS, 300 * MS, 302, False, False),
        (10 * MS + 1, 300 * MS - 1, 10, False, True),
        (10 * MS + 1, 300 * MS - 1, 300, False, True),
        (10 * MS + 1, 300 * MS - 1, 11, True, False),
        (10 * MS + 1, 300 * MS - 1, 299, True, False),
    ],
)
def test_the_largest_force_of_a_run_is_of_its_rows_and_open_by_those_beside(
    begin_ns: int, end_ns: int, row: int, is_in: bool, is_beside: bool
) -> None:
    observed = recorded(run=replace(RUN, begin_ns=begin_ns, end_ns=end_ns), columns=hit_at(row))
    found = seen(observed, "stop_force_n_max")
    assert found.value == pytest.approx(HIT_N if is_in else FORCE_N)
    assert found.uncertainty == pytest.approx(HIT_N - FORCE_N if is_beside else 0.0, abs=0.01)
    assert (found.note == BESIDE) is is_beside


# Behind the run


MOVES_ROW = 350
MOVED = {"set_mm": np.where(K < MOVES_ROW, 2.0, 3.0)}
"""The set value is at rest until a row."""


@pytest.mark.parametrize("end_ns", [300 * MS, 300 * MS + 600 * US, 301 * MS - 1])
@pytest.mark.parametrize(
    ("row", "is_in", "is_beside"),
    [(298, False, False), (299, False, True), (300, True, False), (320, True, False),
     (MOVES_ROW - 1, True, False), (MOVES_ROW, True, False), (MOVES_ROW + 1, False, True),
     (MOVES_ROW + 2, False, False)],
)  # fmt: skip
def test_after_a_run_counts_what_comes_until_the_set_value_moves(
    row: int, is_in: bool, is_beside: bool, end_ns: int
) -> None:
    """The first row with another set value is among them: that one was made after its SYNC."""
    observed = recorded(run=ended_at(end_ns), columns={**MOVED, **hit_at(row)})
    found = seen(observed, "after_run_force_n_max")
    assert found.value == pytest.approx(HIT_N if is_in else FORCE_N)
    assert found.uncertainty == pytest.approx(HIT_N - FORCE_N if is_beside else 0.0, abs=0.01)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("way_um", [5.0, -5.0])
@pytest.mark.parametrize(
    ("rows", "is_in"),
    [(slice(320, 330), True), (slice(345, 352), True), (slice(352, 360), False),
     (slice(250, 260), False), (slice(299, 301), False)],
)  # fmt: skip
def test_what_an_axis_goes_after_its_run_is_counted_from_where_it_ended(
    rows: slice, is_in: bool, way_um: float, side: float
) -> None:
    """To either side, until the set value moves; before the end of the run it is none of it."""
    place = np.full(ROWS, STOP_MM + DEEP_MM)
    place[rows] += way_um * 1e-3
    changes = dict.fromkeys(("truth_mm", "actual_mm"), side * place)
    columns = {**changes, "velocity_mm_s": np.zeros(ROWS), "set_mm": side * MOVED["set_mm"]}
    observed = recorded(side, run=ended_at(301 * MS), columns=columns)
    found = seen(observed, "after_run_motion_um")
    assert found.value == pytest.approx(5.0 if is_in else 0.0, abs=1e-6)
    assert found.note.startswith("over 49 ms; ")


@pytest.mark.parametrize(
    ("end_ns", "words"), [(300 * MS, "over 50 ms"), (DETECTED_NS, "over 146.4 ms")]
)
def test_how_long_an_axis_was_watched_after_its_run_is_in_the_note(end_ns: int, words: str) -> None:
    """From the end of the run, or of its cycle, to the SYNC with another set value."""
    found = seen(recorded(run=ended_at(end_ns), columns=MOVED), "after_run_motion_um")
    assert found.note.startswith(f"{words}; ")


def test_where_the_set_value_never_moves_again_the_recording_is_the_end() -> None:
    still = {"set_mm": np.full(ROWS, 2.0)}
    found = seen(recorded(run=ended_at(300 * MS), columns=still), "after_run_motion_um")
    assert found.note.startswith("over 99 ms; ")
    last = seen(recorded(run=ended_at(399 * MS), columns=still), "after_run_motion_um")
    assert (last.value, last.note.partition(";")[0]) == (0.0, "over 0 ms")
