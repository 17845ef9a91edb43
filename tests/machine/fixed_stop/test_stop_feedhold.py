"""Feedhold of the PLC side in a run to a fixed stop, on a real plant.

10 mm/s and 1000 mm/s²: a ramp takes 10 ms. The axis begins at 100 mm, the stop is at 120 mm.
"""

import pytest
from tests.machine.fixed_stop.conftest import RunStop, StopOutcome

from axisrig.kernel.time.clock import MS

LAG = {"pos_lag_limit": 15_000, "min_time": 100_000}  # 1.5 mm, 100 ms
WINDOW = {"pos_lag_limit": 0, "max_delta_position_window": 1800, "min_time": 20_000}
"""0.18 mm within 20 ms, which is 9 mm/s."""


def feedhold_ns(found: StopOutcome) -> tuple[int, int]:
    events = found.outcome.facts.plc
    on_ns, off_ns = [
        note.time_ns for note in events if note.words in ("feedhold on", "feedhold off")
    ]
    return on_ns, off_ns


@pytest.mark.long
@pytest.mark.parametrize("for_ms", [300, 9])  # it stands; it goes on out of the ramp
def test_the_window_finds_no_stop_in_a_feedhold_in_free_space_and_the_right_one_later(
    run_stop: RunStop, for_ms: int
) -> None:
    """Found so early the axis rests some 10 um off the place: the exact-stop window is 100 um."""
    wide = "set:Z.getriebe[0].window=1000"
    free = run_stop(120, wide, **WINDOW, start_distance=50_000)
    feedhold = f"plc:feedhold=at=run+1s for={for_ms}ms"
    held = run_stop(120, wide, feedhold, **WINDOW, start_distance=50_000)
    assert free.alarms == held.alarms == []
    _, off_ns = feedhold_ns(held)
    assert held.stop.detected_ns is not None
    assert held.stop.detected_ns > off_ns + 900 * MS
    assert held.record.latched_mm["Z"] == pytest.approx(120.03, abs=0.02)


@pytest.mark.long
def test_the_lag_goes_on_counting_in_a_feedhold(run_stop: RunStop) -> None:
    """Held once the lag is beyond its limit the stop is found without a further step; the way back
    waits for the end of the feedhold, and so does the end of the run.
    """
    free = run_stop(120, **LAG)
    beyond_ns = free.stop.beyond_ns["Z"]
    at_ms = (beyond_ns - free.record.begin_ns) // MS + 20
    held = run_stop(120, f"plc:feedhold=at=run+{at_ms}ms for=1s", **LAG)
    _, off_ns = feedhold_ns(held)
    assert (held.stop.beyond_ns["Z"], held.stop.detected_ns) == (beyond_ns, beyond_ns + 100 * MS)
    assert held.stop.relax_begin_ns is not None
    assert held.stop.relax_begin_ns < off_ns < held.record.end_ns  # type: ignore[operator]
    assert held.record.latched_mm["Z"] == pytest.approx(free.record.latched_mm["Z"], abs=1e-3)
    assert held.alarms == []


@pytest.mark.long
def test_a_lag_that_stays_below_its_limit_in_a_feedhold_is_no_stop(run_stop: RunStop) -> None:
    """50 ms behind the contact the set value is 0.5 mm too far; it is held there, then goes on."""
    free = run_stop(120, **LAG)
    at_ms = (free.stop.beyond_ns["Z"] - free.record.begin_ns) // MS - 75
    held = run_stop(120, f"plc:feedhold=at=run+{at_ms}ms for=2s", **LAG)
    on_ns, off_ns = feedhold_ns(held)
    assert held.stop.detected_ns is not None
    # 75 ms less the half of both ramps that are behind the limit's 0.75 mm
    later_ns = held.stop.beyond_ns["Z"] - free.stop.beyond_ns["Z"]
    assert later_ns == pytest.approx(off_ns - on_ns, abs=3 * MS)
    assert held.stop.detected_ns == held.stop.beyond_ns["Z"] + 100 * MS
    assert held.alarms == []


@pytest.mark.long
def test_a_feedhold_on_the_way_back_lets_the_run_end_later(run_stop: RunStop) -> None:
    free = run_stop(120, **LAG)
    at_ms = (free.stop.relax_begin_ns - free.record.begin_ns) // MS + 40  # type: ignore[operator]
    held = run_stop(120, f"plc:feedhold=at=run+{at_ms}ms for=500ms", **LAG)
    _, off_ns = feedhold_ns(held)
    assert held.record.end_ns is not None
    assert held.record.end_ns > off_ns
    assert held.stop.watch_on_ns == held.record.end_ns
    assert held.record.latched_mm == free.record.latched_mm
    assert held.alarms == []
