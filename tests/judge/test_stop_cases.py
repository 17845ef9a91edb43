"""Runs to a fixed stop with feed forward, an axis of another run, and an end that is not known."""

from dataclasses import replace

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEMAND,
    DETECT,
    E0_MM,
    END_NS,
    LOAD,
    ROWS,
    RUN,
    STOP,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.run import stop_runs
from axisrig.kernel.time.clock import MS, US


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("share", "kv"), [(0.0, 50.0), (0.5, 25.0), (0.8, 10.0)])
def test_feed_forward_takes_its_share_off_the_lag(share: float, kv: float, side: float) -> None:
    """(1 - share) v/Kv is 0.2 mm in each: found at 203.6 ms where 202.3 ms are expected."""
    observed = recorded(side, plant={"feed_forward": share, "kv": kv})
    found = seen(observed, "detection_error_ms")
    assert found.value == pytest.approx(203.6 - 202.3, abs=1e-6)
    (run,) = stop_runs(observed)
    assert run.running_lag_mm("Z", 10.0) == pytest.approx(E0_MM)
    off = recorded(side, plant={"feed_forward": share, "kv": kv * 1.2})
    assert "the lag had not settled" in seen(off, "detection_error_ms").note


def test_a_run_has_the_axes_that_it_is_about() -> None:
    """X has a plant too, and takes part in nothing."""
    observed = recorded(run=replace(RUN, fixed_stop=replace(STOP, axes=("Z",))))
    (run,) = stop_runs(observed)
    assert list(run.truths) == ["Z"]
    assert run.watched == ["Z"]


def test_rows_of_a_run_are_from_its_begin_to_its_end_both_among_them() -> None:
    """10 ms to 300.6 ms: rows 10 to 300; without an end until that of the program."""
    (run,) = stop_runs(recorded())
    assert (run.rows.start, run.rows.stop) == (10, 301)
    assert run.end_ns == END_NS
    (whole,) = stop_runs(recorded(run=replace(RUN, end_ns=300 * MS)))
    assert whole.rows.stop == 301
    (open_run,) = stop_runs(recorded(run=replace(RUN, end_ns=None)))
    assert (open_run.end_ns, open_run.rows.stop) == (399 * MS, 400)


def test_the_axis_of_a_run_is_who_found_else_who_met_its_stop_else_the_first() -> None:
    (found,) = stop_runs(recorded())
    assert found.main_axis() == "Z"
    assert found.is_found
    missed = replace(STOP, detected_ns=None, detected_by="")
    (met,) = stop_runs(recorded(run=replace(RUN, fixed_stop=missed)))
    assert (met.main_axis(), met.is_found, met.deciding_criterion()) == ("Z", False, None)
    assert met.earliest_contact is not None
    axis, contact = met.earliest_contact
    assert axis == "Z"
    assert contact.time_ns == pytest.approx(CONTACT_MS * MS, abs=1e-3 * MS)
    none = dict.fromkeys(("stop_force_n", "stop_force_peak_n"), np.zeros(ROWS))
    far = recorded(plant={"stop_position": 9.0}, run=replace(RUN, fixed_stop=missed), columns=none)
    (free,) = stop_runs(far)
    assert free.earliest_contact is None
    assert free.main_axis() == "Z"
    assert free.contact("X") is None


def test_who_has_found_a_stop_is_the_axis_of_the_run_whoever_met_one_before() -> None:
    (run,) = stop_runs(recorded(run=replace(RUN, fixed_stop=replace(STOP, detected_by="X"))))
    assert run.main_axis() == "X"


def test_a_lag_that_is_compensated_too_far_is_a_running_lag_too() -> None:
    """P-AXIS-00191 = 30: e0 = 0.2 + (2 - 30) 0.01 = -0.08 mm, and a limit of 0.05 mm is below."""
    written = {"antr.nbr_delay_cycles": 30, DETECT + "pos_lag_limit": 500}
    note = seen(recorded(written=written), "detection_error_ms").note
    assert note.startswith(
        "no closed form: the lag limit 0.05 mm is not above the running lag 0.08"
    )


def test_who_stops_too_early_is_judged_by_what_would_have_come() -> None:
    """Found at 170.6 ms, the set value brakes at 180 ms; with it going on it were 202.3 ms."""
    early = replace(STOP, detected_ns=170 * MS + 600 * US)
    demand = np.minimum(DEMAND, DEMAND[180])
    observed = recorded(
        run=replace(RUN, fixed_stop=early, signal_ns=early.detected_ns),
        columns={"drive_lag_mm": demand - LOAD, "set_mm": demand},
    )
    assert seen(observed, "detection_error_ms").value == pytest.approx(170.6 - 202.3, abs=1e-6)
