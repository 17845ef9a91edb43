"""Metrics under each choice of the law, [distance] of a rig: rest, ringing, overshoot, own model.

One dead cycle (optimized scheduling); 12.8.3: kp 0.3, Tv 0.01 s, mean of 20, 10 mm/s, 100 mm/s2.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance.findings import control_findings
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import known_metrics, parse_check

P = "set:Z.kenngr.distc."
LIST = (f"{P}optimized_scheduling=1", f"{P}v_max=10000", f"{P}a_max=100", f"{P}n_cycles=20",
        f"{P}kp=0.3", f"{P}d_tv=0.01")  # fmt: skip
UP = ("plant:gap.lift_mm=0.3", "plant:gap.lift_begin_ms=60.5", "plant:gap.lift_end_ms=60.5")
CLAMP, OF_ERROR = "distance:limiter=clamp", "distance:derivative_of=error"
Run = Callable[..., Observed]


@pytest.fixture
def run(run_nc: Callable[..., Any]) -> Run:
    def made(seconds: float, *assignments: str, mode: str = "CONST_DIST SET_DIST=2") -> Observed:
        text = f"N10 Z[DIST_CTRL ON {mode}]\nN20 G04 {seconds}\nN30 Z[DIST_CTRL OFF NO_MOVE]"
        observed = run_nc(text, "", *LIST, *UP, *assignments, base="distance-z.toml").observed
        assert isinstance(observed, Observed)
        return observed

    return made


def of(observed: Observed, metric: str) -> Observation:
    words = known_metrics()[metric].words
    condition = f"== {words.split()[0]}" if words else "!= 0"
    return observe(observed, parse_check(metric, condition, "here"))


@pytest.mark.long
def test_the_list_of_12_8_3_under_its_own_limits(run: Run) -> None:
    """59 um past and at rest; foretold v T (1 + 9.5) = 105 um where v_max is reached."""
    seen = run(1.6)
    assert of(seen, "distance_overshoot_mm").value == pytest.approx(0.059, rel=0.05)
    assert of(seen, "distance_overshoot_expected_mm").value == pytest.approx(0.105)
    assert of(seen, "distance_stability").value == "stable"
    assert of(seen, "offset_model_error_um").value == pytest.approx(0.0, abs=1e-3)
    (block,) = control_findings(seen)
    (law,) = block.laws
    assert law.formula == (
        "o += slope(PID(SET_DIST − filter(d))); D: Tv/T times the change of the feedback"
    )
    assert law.growth == pytest.approx(0.998397, abs=5e-7)
    acts = {limit.key: limit.acts for limit in block.limits}
    assert (acts["v_max"], acts["a_max"]) == ("slopes", "slopes")


@pytest.mark.long
def test_the_same_with_clamps(run: Run) -> None:
    """262 um past; (v - a/K)^2/2a of clamps where v_max is reached; the older law in words."""
    seen = run(0.4, CLAMP, OF_ERROR)
    assert of(seen, "distance_overshoot_mm").value == pytest.approx(0.262, rel=0.05)
    assert of(seen, "distance_overshoot_expected_mm").value == pytest.approx(0.467, abs=1e-3)
    assert of(seen, "offset_model_error_um").value == pytest.approx(0.0, abs=1e-3)
    (block,) = control_findings(seen)
    formula = block.laws[0].formula
    assert formula.startswith("o += clamp(PID(")
    assert formula.endswith("D: Tv/T times the change of the error")
    assert {limit.acts for limit in block.limits[:2]} == {"clamps"}


@pytest.mark.long
def test_a_slope_does_not_make_a_loop_stable_that_rings_by_its_kp(run: Run) -> None:
    """12.8.3 without D: growth 1.0149, a limit cycle of 11 um."""
    seen = run(1.6, f"{P}d_tv=0")
    assert of(seen, "distance_stability").value == "unstable"
    assert of(seen, "distance_growth_expected").value == pytest.approx(1.0149, abs=1e-4)


@pytest.mark.long
def test_the_surface_law_is_foretold_to_stop_at_the_surface(run: Run) -> None:
    seen = run(0.5, mode="SET_POS=30")
    assert of(seen, "distance_overshoot_expected_mm").value == 0.0
    overshoot = of(seen, "distance_overshoot_mm").value
    assert isinstance(overshoot, float)
    assert overshoot <= 1e-5  # an increment of the sensor


@pytest.mark.long
def test_a_wrong_law_would_not_follow_the_own_model(run: Run) -> None:
    """The frames of each choice differ, and each follows its model: the judge knows which acted."""
    hashes = set()
    for choices in ((), (CLAMP,), ("distance:derivative=per_cycle",)):
        seen = run(0.3, *choices)
        assert of(seen, "offset_model_error_um").value == pytest.approx(0.0, abs=1e-3)
        hashes.add(seen.facts.frame_log_sha256)
    assert len(hashes) == 3


@pytest.mark.long
def test_parameters_about_cycles_change_no_dead_cycle(run: Run) -> None:
    """P-AXIS-00191 and P-AXIS-00276: by frames, by the arithmetic of the rig, and every offset."""
    other = (
        "set:Z.antr.nbr_delay_cycles=7",
        "set:Z.lr_param.field_bus_allows_optimized_schedule=1",
    )
    seen = [run(0.2, *items) for items in ((), other)]
    assert [of(one, "distance_dead_cycles").value for one in seen] == [1, 1]
    assert [of(one, "distance_dead_cycles_expected").value for one in seen] == [1, 1]
    first, second = (one.column("Z", "offset_mm") for one in seen)
    rows = min(len(first), len(second))
    assert rows > 200
    assert np.array_equal(first[:rows], second[:rows])
    assert float(np.max(np.abs(first))) > 0.2
