"""Which steps of an offset show how a loop grows, and what is motion of a surface."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ROWS, WITH_CONST_DIST, K, N, no_value, recorded, seen

from axisrig.bench.judge.distance.control_stretches import (
    _has_moved,
    _rounding_mm,
    last_active,
    of_last_filter,
)
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.oracles.distance.stability import KP_MAX
from axisrig.bench.record.distance import DistanceOrder
from axisrig.kernel.time.clock import MS

JUMP = np.where(K < 300, 0.0, 1.0)
SINCE = np.maximum(K - 300.0, 0.0)


def truth_of(**of: Any) -> DistanceTruth:
    truth = distance_truth(recorded(**of), "Z")
    assert truth is not None
    return truth


@pytest.mark.parametrize("factor", [1.05, 1.1])
def test_a_loop_that_grows_into_its_limits_shows_its_growth_before_them(factor: float) -> None:
    """From 0.1 um on to 50 um, which a limit holds from then on."""
    free = np.where(K > 300, 1e-4 * factor ** np.minimum(SINCE, 500.0), 0.0)
    columns = {"step_mm": np.minimum(free, 0.05), "delta_mm": np.minimum(free, 1.0)}
    found = seen(recorded(0.0, JUMP, columns=columns), "distance_growth")
    assert found.value == pytest.approx(factor, abs=1e-6)
    assert found.uncertainty == pytest.approx(1e-6, rel=1e-3)  # what rounding leaves of it
    assert seen(recorded(0.0, JUMP, columns=columns), "distance_stability").value == "unstable"


@pytest.mark.parametrize("count", [1, 20])
def test_steps_count_when_filter_and_dead_cycles_have_filled(count: int) -> None:
    """Until then they are as it happens, after it each is 0.9 of the one before."""
    filled = 300 + count + N + 3
    odd = np.where(K > 300, np.sin(K * K * 1.0), 0.0)
    step = np.where(filled <= K, 0.1 * 0.9 ** np.maximum(K - filled * 1.0, 0.0), odd)
    columns = {"step_mm": step, "delta_mm": step}
    observed = recorded(0.0, JUMP, words={"n_cycles": count}, columns=columns)
    found = seen(observed, "distance_growth")
    assert found.value == pytest.approx(0.9, abs=1e-6)
    assert found.uncertainty == pytest.approx(0.0, abs=1e-5)


def test_what_is_excited_all_the_time_is_looked_at_from_its_begin_on() -> None:
    """The surface moves until the end: steps of one size show no growth, those that grow do."""
    wavy, on = 0.5 * np.sin(0.3 * K), {"distance_state": ((K >= 100) & (K < 280)) * 4.0}
    even = {**on, "step_mm": np.full(ROWS, 0.01), "delta_mm": np.full(ROWS, 0.01)}
    assert no_value(recorded(0.0, wavy, columns=even), "distance_growth").startswith("something")
    grows = 1e-4 * 1.01 ** np.maximum(K - 100.0, 0.0)
    columns = {**on, "step_mm": grows, "delta_mm": grows}
    found = seen(recorded(0.0, wavy, columns=columns), "distance_growth")
    assert found.value == pytest.approx(1.01, abs=1e-6)


@pytest.mark.parametrize("count", [1, 4])
@pytest.mark.parametrize("kp", [0.2, 0.4])
def test_an_increment_of_the_sensor_makes_a_step_by_p_part_and_d_part(
    kp: float, count: int
) -> None:
    """The P part has it whole; the D part as sqrt(2)/N of it, by a mean of N values.

    Tv of 3 ms is 3 cycles: the D part is 3 times the change in a cycle.
    """
    plain = truth_of(words={"kp": kp, "n_cycles": count})
    mm = plain.increment_mm * kp
    assert _rounding_mm(plain, last_active(plain)) == pytest.approx(mm)
    of = truth_of(words={"kp": kp, "n_cycles": count, "d_tv": 0.003})
    stretch = last_active(of)
    expected = mm * (1.0 + 3.0 * math.sqrt(2.0) / count)
    assert _rounding_mm(of, stretch) == pytest.approx(expected)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("gain", [1.0, 0.5])
def test_a_surface_moves_where_its_gap_changes_by_more_than_the_tool_makes(
    gain: float, sign: float
) -> None:
    """Below an inclined tool by more than 10 nm and 1 % of its way, else by more than 0.2 nm."""
    ways = sign * np.array([0.0, 0.1, 0.1, 0.0, 0.0, 0.1])
    allowed = np.full(6, 2e-7) if gain == 1.0 else 1e-5 + 0.01 * np.abs(ways)
    beside = np.array([0.0, 0.9, 1.1, 0.9, -1.1, -0.9]) * allowed

    class Truth(SimpleNamespace):
        def __getitem__(self, name: str) -> Any:
            assert name == "truth_mm"
            return np.cumsum(ways)

    truth: Any = Truth(gap_gain=gain, gap_true_mm=np.cumsum(gain * ways + beside))
    assert _has_moved(truth).tolist() == [False, False, True, False, True, False]


def test_of_all_stretches_those_with_the_last_filter_go_together() -> None:
    """Whatever else their law is, dry runs too."""
    words = (
        (200, {"n_cycles": 5}),
        (300, {"kp": 0.3}),
        (500, {"n_cycles": 1}),
        (700, {"n_cycles": 5}),
    )
    orders = tuple(DistanceOrder(row * MS, "NC", words=of) for row, of in words)
    found = of_last_filter(truth_of(orders=(WITH_CONST_DIST, *orders)))
    assert [(one.begin, one.end) for one in found] == [(201, 301), (301, 501), (701, ROWS)]
    one = of_last_filter(truth_of(orders=(WITH_CONST_DIST, *orders[:3])))
    assert [(stretch.begin, stretch.end) for stretch in one] == [(100, 201), (501, ROWS)]


def test_the_limit_of_kp_is_that_of_the_law_that_acted_last() -> None:
    """CONST_DIST with n = 2: the pole is on the circle at 2 sin(pi/10) = 0.618.

    With a mean of two values it is less; what is always stable has the largest kp there is.
    """
    plain = recorded()
    known = seen(plain, "distance_kp_limit")
    assert known.value == pytest.approx(2.0 * math.sin(math.pi / 10.0), abs=1e-6)
    assert seen(plain, "distance_growth_expected").value < 1.0
    later = DistanceOrder(500 * MS, "NC", words={"kp": 0.7})
    of = recorded(orders=(WITH_CONST_DIST, later))
    assert seen(of, "distance_kp_limit").value == pytest.approx(known.value)
    assert seen(of, "distance_growth_expected").value > 1.0
    filtered = DistanceOrder(500 * MS, "NC", words={"n_cycles": 2})
    assert seen(recorded(orders=(WITH_CONST_DIST, filtered)), "distance_kp_limit").value < 0.618
    assert KP_MAX >= seen(recorded(state=1), "distance_kp_limit").value > known.value
    truth = truth_of()
    assert truth.mode_in(1, truth.listed) == SET_POS
    assert truth.mode_in(4, truth.listed) == CONST_DIST


def test_the_last_cycle_with_the_control_on_is_not_the_last_of_the_run() -> None:
    state = np.where((K < 100) | (K >= 600), 0.0, 4.0)
    behind = np.where(K == 599, 0.25, np.where(K == 999, 9.0, 0.125))
    found = seen(recorded(behind, columns={"distance_state": state}), "distance_behind_end_um")
    assert found.value == pytest.approx(250.0)
    assert found.uncertainty == pytest.approx(0.1)
