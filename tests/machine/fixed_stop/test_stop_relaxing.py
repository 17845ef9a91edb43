"""What is behind the detection: back to the measured value, no jump, and what may go wrong."""

import numpy as np
import pytest
from tests.machine.fixed_stop.conftest import RunStop

LAG = {"pos_lag_limit": 15_000, "min_time": 100_000}
RATED_N = 2.2 * 2 * np.pi / 0.01
RESTORE = """\
N210 G4 1
N220 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=5000 WAIT]
N230 G4 1
"""


@pytest.mark.long
def test_behind_the_run_there_is_no_lag_and_no_jump_when_the_limit_is_restored(
    run_stop: RunStop,
) -> None:
    """Command, actual value and stop agree: restoring the torque limit moves nothing."""
    found = run_stop(120, end=RESTORE, **LAG)
    times, end_ns = found.outcome.column("time_ns"), found.record.end_ns
    assert end_ns is not None
    behind = times > end_ns
    lag_mm = found.outcome.column("Z.cnc_lag_mm")[behind]
    truth_mm = found.outcome.column("Z.truth_mm")[behind]
    force_n = found.outcome.column("Z.stop_force_n")[behind]
    assert np.abs(lag_mm).max() <= 0.01  # the exact-stop window
    assert abs(lag_mm[-1]) < 2e-5
    assert np.ptp(truth_mm) * 1e3 < 1.0
    assert force_n.max() <= 0.4 * RATED_N * 1.001


@pytest.mark.long
def test_without_enough_lag_the_axis_is_led_to_where_it_is(run_stop: RunStop) -> None:
    """P-CHAN-00266 = 1: 30 mm of lag are too little for 50; no value, no lag in the end."""
    missed = run_stop(
        120, "set:channel.meas_fixed_stop_no_error=1", pos_lag_limit=500_000, min_time=100_000
    )
    assert (missed.alarms, missed.record.latched_mm) == ([], {})
    static_mm = 120 + 0.4 * RATED_N / 20 / 1e3
    assert missed.outcome.printed("ABS") == [pytest.approx(static_mm, abs=1e-3)]


@pytest.mark.provokes(900005, 7, axis="Z")
@pytest.mark.long
def test_a_following_error_window_left_on_ends_the_run_without_a_value(run_stop: RunStop) -> None:
    """6065 of 1 mm, 6066 of 0 ms: 8611, and the CNC monitors the lag again."""
    failed = run_stop(120, lag_window=104_857, **LAG)
    assert failed.alarms == [900005]
    assert "8611" in str(failed.outcome.machine.channel.alarms[0])
    assert failed.record.latched_mm == {}
    link = failed.outcome.machine.channel.links[0]
    assert link.watches_lag
    assert failed.stop.watch_on_ns is not None


@pytest.mark.long
def test_a_stop_before_the_arming_is_found_when_the_path_has_got_there(run_stop: RunStop) -> None:
    """Pressed for 2 s before 30 mm of the path are travelled; 100 ms later it is found."""
    found = run_stop(110, start_distance=300_000, **LAG)
    stop = found.stop
    assert stop.armed_ns is not None
    assert stop.beyond_ns["Z"] == stop.armed_ns
    assert stop.detected_ns == stop.armed_ns + 100_000_000
    assert found.record.latched_mm["Z"] == pytest.approx(110 + 0.4 * RATED_N / 20e3, abs=1e-3)


# Triggers without contact that follow from the settings


@pytest.mark.long
def test_a_limit_below_the_running_lag_fires_in_free_space(run_stop: RunStop) -> None:
    """The running lag is 0.25 mm; a little above it nothing fires."""
    for limit, is_free in ((2_400, True), (2_600, False)):
        found = run_stop(140, pos_lag_limit=limit, min_time=100_000)
        assert (found.record.latched_mm["Z"] < 110) is is_free


def test_the_window_without_start_distance_fires_when_the_block_begins(run_stop: RunStop) -> None:
    fired = run_stop(140, pos_lag_limit=0, min_time=100_000, max_delta_position_window=20)
    assert fired.stop.detected_ns == fired.stop.armed_ns
    assert fired.record.latched_mm["Z"] == pytest.approx(100, abs=0.01)  # exact-stop window


@pytest.mark.parametrize(("window_um", "is_free"), [(1_010, True), (990, False)])
@pytest.mark.long(but=1)
def test_a_window_as_fast_as_the_feed_fires_in_free_space(
    run_stop: RunStop, window_um: int, is_free: bool
) -> None:
    """10 mm/s and 100 ms are 1 mm."""
    found = run_stop(
        140,
        pos_lag_limit=0,
        min_time=100_000,
        max_delta_position_window=window_um * 10,
        start_distance=100_000,
    )
    assert (found.record.latched_mm["Z"] < 120) is is_free


@pytest.mark.provokes(900240, 4, axes="Z")
@pytest.mark.long
def test_the_window_alone_finds_nothing_at_the_target(run_stop: RunStop) -> None:
    missed = run_stop(
        None,
        pos_lag_limit=0,
        min_time=100_000,
        max_delta_position_window=20,
        start_distance=50_000,
    )
    assert missed.alarms == [900240]
