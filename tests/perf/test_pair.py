"""Two coupled FMUs three ways: the same values, timed with a clock that counts."""

from itertools import count

import pytest
from tests.perf import pair_perf


@pytest.mark.long
def test_three_ways_to_step_come_to_the_same_values(monkeypatch: pytest.MonkeyPatch) -> None:
    """`measure_pair` refuses values that differ; each way takes one tick of 1 us here."""
    monkeypatch.setattr(pair_perf, "STEPS", 20)
    monkeypatch.setattr(pair_perf, "ROUNDS", 2)
    ticks = count(0, 1000)
    found = pair_perf.measure_pair(1, lambda: next(ticks))
    for name in ("c_loop_us", "ours_us", "fmpy_us"):
        assert found[name] == pytest.approx(1.0 / 20)
    assert found["beyond_c_us"] == found["fmpy_beyond_c_us"] == 0.0


@pytest.mark.long
def test_the_ratio_is_of_what_is_beyond_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """C takes 1 us, ours 3 and fmpy 6 for 20 steps: 2 beyond C beside 5."""
    monkeypatch.setattr(pair_perf, "STEPS", 20)
    monkeypatch.setattr(pair_perf, "ROUNDS", 1)
    instants = iter([0, 1000, 1000, 4000, 4000, 10000])
    assert pair_perf.measure_pair(1, lambda: next(instants))["ratio"] == pytest.approx(2 / 5)
