"""When and where a stop is found on a real plant: closed forms on the truth of the plant alone.

t_c: contact, from the true position. e0 = v / kv + (2 - d) v T, the lag of a running axis that a
cycle judges: set position of d cycles ago less the actual position of the SYNC. delta = F / k.
"""

import numpy as np
import pytest
from tests.machine.fixed_stop.conftest import RunStop, StopOutcome

KV, D, PERIOD_S, PERIOD_NS = 40.0, 2, 1e-3, 1_000_000
STIFFNESS_N_UM = 20.0
RATED_N = 2.2 * 2 * np.pi / 0.01  # 2.2 N m on a screw of 10 mm
BAND_NS = 2 * PERIOD_NS
INCREMENT_UM = 1e4 / 2**20


def contact_ns(found: StopOutcome, stop_mm: float, direction: int = 1) -> float:
    """First contact, straight between two SYNCs."""
    times, truth = found.outcome.column("time_ns"), found.outcome.column("Z.truth_mm")
    behind = direction * (truth - stop_mm) >= 0
    k = int(np.argmax(behind & (times > found.record.start_ns)))
    share = (stop_mm - truth[k - 1]) / (truth[k] - truth[k - 1])
    return float(times[k - 1] + share * (times[k] - times[k - 1]))


def at_sync(found: StopOutcome, column: str, cycle_ns: int | None) -> float:
    """A column of the trace at the SYNC of an NC cycle."""
    assert cycle_ns is not None
    times = found.outcome.column("time_ns")
    row = np.searchsorted(times, cycle_ns) - 1
    assert cycle_ns - times[row] < PERIOD_NS
    return float(found.outcome.column(column)[row])


def e0_mm(v_mm_s: float) -> float:
    return v_mm_s / KV + (2 - D) * v_mm_s * PERIOD_S


@pytest.mark.long
@pytest.mark.parametrize(
    ("feed", "limit_mm", "time_ms"),
    [(120, 0.5, 100), (600, 3.0, 100), (600, 1.5, 250), (3000, 12.5, 100)],
)
@pytest.mark.parametrize("direction", [1, -1])
def test_found_by_the_lag(
    run_stop: RunStop, feed: float, limit_mm: float, time_ms: int, direction: int
) -> None:
    """t_det = t_c + (L - e0 + delta) / v + tau, for limits met behind the ringing."""
    stop_mm, start = (110.0, 100.0) if direction > 0 else (90.0, 100.0)
    found = run_stop(
        stop_mm,
        f"plant:z.stop_direction={direction}",
        start=start,
        target=100 + direction * 45,
        feed=feed,
        pos_lag_limit=round(limit_mm * 1e4),
        min_time=time_ms * 1000,
    )
    v_mm_s = feed / 60
    delta_mm = 0.4 * RATED_N / STIFFNESS_N_UM / 1e3
    expected_ns = (
        contact_ns(found, stop_mm, direction)
        + (limit_mm - e0_mm(v_mm_s) + delta_mm) / v_mm_s * 1e9
        + time_ms * 1e6
    )
    assert found.alarms == []
    assert found.stop.detected_ns == pytest.approx(expected_ns, abs=BAND_NS)
    measured_mm = found.record.latched_mm["Z"]
    assert direction * (measured_mm - stop_mm) == pytest.approx(delta_mm, abs=1e-3)


@pytest.mark.long
@pytest.mark.parametrize(("feed", "window_mm"), [(300, 0.05), (600, 0.1), (600, 0.2)])
def test_found_by_the_window(run_stop: RunStop, feed: float, window_mm: float) -> None:
    """t_det = t_c + tau - (W - delta) / v; the first 5 mm have no window."""
    found = run_stop(
        110,
        feed=feed,
        pos_lag_limit=0,
        min_time=100_000,
        max_delta_position_window=round(window_mm * 1e4),
        start_distance=50_000,
    )
    delta_mm = 0.4 * RATED_N / STIFFNESS_N_UM / 1e3
    expected_ns = contact_ns(found, 110.0) + 100e6 - (window_mm - delta_mm) / (feed / 60) * 1e9
    assert found.alarms == []
    assert found.stop.detected_ns == pytest.approx(expected_ns, abs=BAND_NS)


@pytest.mark.long
def test_of_both_criteria_the_later_decides(run_stop: RunStop) -> None:
    settings = {"min_time": 100_000, "max_delta_position_window": 20, "start_distance": 50_000}
    window = run_stop(110, pos_lag_limit=0, **settings)
    lag = run_stop(110, pos_lag_limit=15_000, min_time=100_000)
    both = run_stop(110, pos_lag_limit=15_000, **settings)
    assert window.stop.detected_ns < lag.stop.detected_ns == both.stop.detected_ns
    assert window.stop.detected_ns <= both.stop.window_ns["Z"] < both.stop.detected_ns
    assert both.stop.beyond_ns == lag.stop.beyond_ns


@pytest.mark.long
@pytest.mark.parametrize("stiffness", [20e6, 100e6, 500e6])
def test_the_value_is_that_of_the_contact_force(run_stop: RunStop, stiffness: float) -> None:
    """F of the plant itself over k, at any limit and time; the last bit is the encoder.

    The torque limit alone counts when the ringing is over (2 m / (F alpha) = 34 ms).
    """
    for limit, time_us, ringing_n in ((5_000, 100_000, 100.0), (30_000, 300_000, 1.0)):
        given = f"plant:z.stop_stiffness={stiffness}"
        found = run_stop(110, given, pos_lag_limit=limit, min_time=time_us)
        force_n = at_sync(found, "Z.stop_force_n", found.stop.detected_ns)
        value_um = (found.record.latched_mm["Z"] - 110) * 1e3
        assert value_um == pytest.approx(force_n / (stiffness / 1e6), abs=0.05 + INCREMENT_UM)
        assert force_n == pytest.approx(0.4 * RATED_N, abs=ringing_n)


@pytest.mark.long
@pytest.mark.parametrize(("speed_m_s", "end_s"), [(-0.5e-3, 1.2), (0.5e-3, 1.2), (0.5e-3, 2.5)])
def test_a_stop_that_moves_is_measured_where_it_is_when_it_is_found(
    run_stop: RunStop, speed_m_s: float, end_s: float
) -> None:
    """It moves against or with the axis while that comes and presses; found after 1.3 s."""
    found = run_stop(
        110,
        f"plant:z.stop_speed={speed_m_s}",
        "plant:z.stop_begin=0.5",
        f"plant:z.stop_end={end_s}",
        pos_lag_limit=15_000,
        min_time=100_000,
    )
    assert found.alarms == []
    place_mm = at_sync(found, "Z.stop_mm", found.stop.detected_ns)
    force_n = at_sync(found, "Z.stop_force_n", found.stop.detected_ns)
    assert abs(place_mm - 110) > 0.2
    measured_mm = found.record.latched_mm["Z"]
    assert measured_mm == pytest.approx(place_mm + force_n / STIFFNESS_N_UM / 1e3, abs=1e-4)


@pytest.mark.long
@pytest.mark.provokes(70082, 5, axis="Z")
def test_a_time_shorter_than_the_ringing_is_in_the_value(run_stop: RunStop) -> None:
    """50 mm/s push 191 kg up to v sqrt(m/k) = 0.15 mm into 20 N/um; F/k are 0.028 mm.

    Found in there the value is a place that the torque limit does not reach again.
    """
    static_mm = 110 + 0.4 * RATED_N / STIFFNESS_N_UM / 1e3
    early = run_stop(110, feed=3000, pos_lag_limit=13_000, min_time=2_000)
    assert early.alarms == [70082]
    assert 0.05 < early.stop.actual_mm["Z"] - static_mm < 0.15
    late = run_stop(110, feed=3000, pos_lag_limit=13_000, min_time=250_000)
    assert late.alarms == []
    assert late.record.latched_mm["Z"] == pytest.approx(static_mm, abs=1e-4)
