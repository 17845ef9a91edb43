"""Instants of testplans/fixed_stop_timing.csv from closed forms; nothing of the bench."""

import pytest
from tests.plans.fixed_stop_law import Axis, axes, axis
from tests.plans.fixed_stop_setup import band, is_rounded, rows, tolerance

ROWS = rows()
DETECTED = [name for name, row in ROWS.items() if row["check:contact_to_detection_ms"]]
EXCESS = [name for name, row in ROWS.items() if row["check:command_overtravel_mm"]]
AT_STANDSTILL = ["target-just-far-enough"]


def _deciding(name: str) -> Axis:
    """The axis that has the stop."""
    known = axes(ROWS[name])
    return known.get("X") or known["Z"]


@pytest.mark.parametrize("case", DETECTED)
def test_detection_is_one_cycle_exactly(case: str) -> None:
    """From contact to the NC cycle that finds the stop, of both criteria the later one.

    Lag: t_c + (L - e0 + F/k)/v + tau, window: t_c + tau - (W - F/k)/v, and never before the arming;
    then the next SYNC and the NC cycle after it.
    """
    found = _deciding(case)
    low, high = band(ROWS[case]["check:contact_to_detection_ms"])
    expected_low, expected_high = found.detection
    assert is_rounded(low, expected_low * 1e3, 4)
    assert is_rounded(high, expected_high * 1e3, 4)
    wide = found.penetration[1] - found.penetration[0]
    assert wide == 0.0, "friction would widen the band"


@pytest.mark.parametrize("case", DETECTED)
def test_what_is_not_sampling_in_a_band_is_small(case: str) -> None:
    """Ringing and start-up are below a fifth of a cycle on either side."""
    found = _deciding(case)
    low, high = found.detection
    assert found.T <= high - low <= found.T * 1.4


@pytest.mark.parametrize("case", EXCESS)
def test_command_behind_the_latched_position(case: str) -> None:
    """L + v (tau + t_d) + v²/2a, one cycle wide; a command that has its target ends there."""
    text, found = ROWS[case]["check:command_overtravel_mm"], axis(ROWS[case])
    if case in AT_STANDSTILL:
        middle, width = tolerance(text)
        target = float(ROWS[case]["plc:V.E.TARGET"])
        assert is_rounded(middle, target - found.place[0], 5)
        assert float(width) == 0.001
        return
    low, high = band(text)
    assert is_rounded(low, found.excess[0], 5)
    assert is_rounded(high, found.excess[1], 5)


@pytest.mark.parametrize("case", AT_STANDSTILL)
def test_lag_limit_is_exceeded_before_the_command_brakes(case: str) -> None:
    found = axis(ROWS[case])
    limit, brake = found.criteria.lag_mm, found.v * found.v / (2 * found.a)
    assert limit is not None
    target = float(ROWS[case]["plc:V.E.TARGET"])
    assert target - found.place[0] - brake > limit + 2 * found.v * found.T
    ends_s = (target - found.place[0] - limit) / found.v
    assert ends_s < found.criteria.tau_cycles * found.T, "the time ends at standstill"


def test_the_range_of_feeds_cycles_gains_buffers_and_delays() -> None:
    known = [
        axis(ROWS[case])
        for case in DETECTED
        if "plc:V.E.X" in ROWS[case] and not ROWS[case]["plc:V.E.X"]
    ]
    assert {round(each.v * 60) for each in known} >= {100, 300, 600, 1000, 1500, 2000, 3000}
    assert {round(each.T * 1e6) for each in known} == {1000, 2000, 4000}
    assert {each.plant("kv") for each in known} == {10, 20, 40, 80}
    assert {each.plant("feed_forward") for each in known} == {0, 0.5, 1}
    assert {each.buffer_cycles for each in known} == {0, 3, 10}
    assert {each.delay_cycles for each in known} == {0, 1, 2, 4, 8}
    kinds = {
        (each.criteria.lag_mm is not None, each.criteria.window_mm is not None) for each in known
    }
    assert kinds == {(True, False), (False, True), (True, True)}


@pytest.mark.parametrize(
    ("case", "lag_mm", "window_mm", "cycles", "armed_mm"),
    [
        ("lag-00774", 0.9, None, 65, 0),
        ("lag-00769", 1.5, None, 65, 0),
        ("lag-00331", 2.1, None, 65, 0),
        ("lag-00774-off", None, 0.1, 65, 1.5),
        ("lag-00769-off", None, 0.1, 65, 1.5),
        ("lag-00331-off", None, 0.1, 65, 1.5),
        ("time-00775", 0.9, None, 65, 0),
        ("time-00770", 0.9, None, 100, 0),
        ("time-00332", 0.9, None, 140, 0),
        ("time-00332-2ms", 0.9, None, 70, 0),
        ("window-00778", None, 0.1, 65, 1.5),
        ("window-00773", None, 0.2, 65, 1.5),
        ("window-00773-off", 0.9, None, 65, 1.5),
        ("window-without-time-lag", 0.9, None, 0, 0),
        ("arm-00776", 0.2, None, 65, 1.5),
        ("arm-00771", 0.2, None, 65, 1.0),
        ("arm-00777", 0.2, None, 65, 2.0),
        ("arm-00772", 0.2, None, 65, 1.0),
        ("arm-share-smaller", 0.2, None, 65, 1.0),
        ("arm-distance-smaller", 0.2, None, 65, 1.5),
        ("arm-zero-and-share", 0.2, None, 65, 0),
        ("arm-at-once", 0.2, None, 65, 0),
        ("min-time-65.4", 0.9, None, 66, 0),
        ("cycle-4ms", 0.9, None, 17, 0),
    ],
)
def test_every_link_of_the_chains(
    case: str, lag_mm: float | None, window_mm: float | None, cycles: int, armed_mm: float
) -> None:
    """774, 769, 331; 775, 770, 332; 776, 771; 777, 772; 778, 773: FCT-C4 8.2.2."""
    found = axis(ROWS[case])
    assert found.criteria.lag_mm == (None if lag_mm is None else pytest.approx(lag_mm))
    assert found.criteria.window_mm == (None if window_mm is None else pytest.approx(window_mm))
    assert found.criteria.tau_cycles == cycles
    assert found.armed_from == pytest.approx(armed_mm)
